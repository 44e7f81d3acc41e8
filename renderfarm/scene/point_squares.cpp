// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/point_squares.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace cyclorama::scene {
namespace {

using Eigen::Vector3f;

constexpr int kAxisBits = 21;
/// More points of one cell and its neighbours would not change the result.
constexpr std::size_t kMaxCandidates = 512;
constexpr std::size_t kNeighbours = 12;      ///< Number of points that determine a plane.
constexpr std::size_t kNearest = 4;          ///< Number of neighbours that are one step away in a regular grid.

Vector3f point_of(const Mesh& cloud, std::uint32_t index) {
  const std::array<float, 3>& p = cloud.positions[index];
  return {p[0], p[1], p[2]};
}

/// The points of a cloud, sorted by cubic cells.
class PointCells {
 public:
  explicit PointCells(const Mesh& cloud) : cloud_(cloud) {
    Eigen::AlignedBox3f box;
    for (std::uint32_t i = 0; i < cloud.positions.size(); ++i) box.extend(point_of(cloud, i));
    min_ = box.min();
    const float diagonal = std::max(box.diagonal().norm(), 1e-6f);
    const float finest = 2.0f * box.sizes().maxCoeff() / static_cast<float>(1u << kAxisBits);
    // This size suits an even surface; scans that are denser in some parts need a few corrections.
    cell_ = 2.5f * diagonal / std::sqrt(static_cast<float>(cloud.positions.size()));
    constexpr double kFewPerCell = 3.0;
    constexpr double kManyPerCell = 24.0;
    for (int attempt = 0; attempt < 8; ++attempt) {
      cell_ = std::max(cell_, std::max(finest, 1e-30f));
      sort();
      const double per_cell = static_cast<double>(order_.size()) / static_cast<double>(starts_.size() - 1);
      if (per_cell >= kFewPerCell && per_cell <= kManyPerCell) return;
      if (cell_ > 2.0f * diagonal || (cell_ <= finest && per_cell > kManyPerCell)) return;
      cell_ *= per_cell < kFewPerCell ? 1.7f : 0.6f;
    }
  }

  [[nodiscard]] std::size_t count() const { return starts_.size() - 1; }
  /// Calls `use` with each point of cell number `cell`.
  template <typename Use>
  void for_each_in(std::size_t cell, const Use& use) const {
    for (std::size_t i = starts_[cell]; i < starts_[cell + 1]; ++i) use(order_[i].second);
  }
  /// Collects the points of a cell and of the 26 cells around it.
  void candidates(std::size_t cell, std::vector<std::uint32_t>* ret_points) const {
    ret_points->clear();
    const std::uint64_t key = order_[starts_[cell]].first;
    for (int i = 0; i < 27; ++i) {
      const int step = (i + 13) % 27;  // The cell's own points come first and never exceed kMaxCandidates.
      const std::uint64_t near = shifted(key, step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      auto at = std::lower_bound(order_.begin(), order_.end(), std::pair(near, std::uint32_t{0}));
      for (; at != order_.end() && at->first == near && ret_points->size() < kMaxCandidates; ++at) {
        ret_points->push_back(at->second);
      }
    }
  }

 private:
  [[nodiscard]] std::uint64_t key_of(const Vector3f& p) const {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // One is added so that the cell before the first cell has a key as well.
      key = key << kAxisBits | (static_cast<std::uint64_t>((p[axis] - min_[axis]) / cell_) + 1);
    }
    return key;
  }
  static std::uint64_t shifted(std::uint64_t key, int x, int y, int z) {
    const auto step = [](int by, int bits) { return static_cast<std::uint64_t>(std::int64_t{by} << bits); };
    return key + step(x, 2 * kAxisBits) + step(y, kAxisBits) + step(z, 0);
  }
  void sort() {
    order_.clear();
    order_.reserve(cloud_.positions.size());
    for (std::uint32_t i = 0; i < cloud_.positions.size(); ++i) order_.emplace_back(key_of(point_of(cloud_, i)), i);
    std::sort(order_.begin(), order_.end());
    starts_.clear();
    for (std::size_t i = 0; i < order_.size(); ++i) {
      if (i == 0 || order_[i].first != order_[i - 1].first) starts_.push_back(i);
    }
    starts_.push_back(order_.size());
  }

  const Mesh& cloud_;
  Vector3f min_;
  float cell_ = 1.0f;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;  ///< Cell and point.
  std::vector<std::size_t> starts_;
};

struct Surroundings {
  float step = 0.0f;  ///< Distance to the fourth neighbour; 0 if there are fewer.
  Vector3f normal = Vector3f::UnitY();
};

Surroundings surroundings_of(const Mesh& cloud, std::uint32_t point, const std::vector<std::uint32_t>& candidates,
                             std::vector<std::pair<float, std::uint32_t>>* by_distance) {
  const Vector3f middle = point_of(cloud, point);
  by_distance->clear();
  for (const std::uint32_t other : candidates) {
    const float distance = (point_of(cloud, other) - middle).squaredNorm();
    if (distance > 0.0f) by_distance->emplace_back(distance, other);
  }
  const std::size_t count = std::min(kNeighbours, by_distance->size());
  std::partial_sort(by_distance->begin(), by_distance->begin() + static_cast<std::ptrdiff_t>(count),
                    by_distance->end());
  Surroundings found;
  if (count < kNearest) return found;
  found.step = std::sqrt((*by_distance)[kNearest - 1].first);
  Vector3f mean = middle;
  for (std::size_t i = 0; i < count; ++i) mean += point_of(cloud, (*by_distance)[i].second);
  mean /= static_cast<float>(count + 1);
  Eigen::Matrix3f spread = (middle - mean) * (middle - mean).transpose();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3f offset = point_of(cloud, (*by_distance)[i].second) - mean;
    spread += offset * offset.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(spread / std::max(spread.trace(), 1e-30f));
  found.normal = solver.eigenvectors().col(0);
  return found;
}

float median_step(const std::vector<Surroundings>& all) {
  std::vector<float> steps;
  for (const Surroundings& s : all) {
    if (s.step > 0.0f) steps.push_back(s.step);
  }
  if (steps.empty()) return 0.01f;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void add_square(const Vector3f& middle, const Vector3f& normal, float radius, Mesh* squares) {
  const Vector3f n = normal.allFinite() && normal.norm() > 0.5f ? normal.normalized() : Vector3f(Vector3f::UnitY());
  const Vector3f across = n.unitOrthogonal() * radius;
  const Vector3f up = n.cross(across);
  const auto first = static_cast<std::uint32_t>(squares->positions.size());
  for (const Vector3f& p :
       {Vector3f(middle + across), Vector3f(middle + up), Vector3f(middle - across), Vector3f(middle - up)}) {
    squares->positions.push_back({p.x(), p.y(), p.z()});
  }
  squares->triangles.push_back({first, first + 1, first + 2});
  squares->triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

double make_point_squares(Mesh* cloud) {
  const std::size_t count = cloud->positions.size();
  std::vector<Surroundings> around(count);
  {
    const PointCells cells(*cloud);
    std::vector<std::uint32_t> candidates;
    std::vector<std::pair<float, std::uint32_t>> by_distance;
    for (std::size_t cell = 0; cell < cells.count(); ++cell) {
      cells.candidates(cell, &candidates);
      cells.for_each_in(
          cell, [&](std::uint32_t point) { around[point] = surroundings_of(*cloud, point, candidates, &by_distance); });
    }
  }
  const float usual = median_step(around);
  Mesh squares;
  squares.positions.reserve(4 * count);
  squares.triangles.reserve(2 * count);
  squares.colours.reserve(cloud->colours.empty() ? 0 : 4 * count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float step = around[i].step > 0.0f ? around[i].step : usual;
    const bool has_normal = !cloud->normals.empty();
    const Vector3f normal =
        has_normal ? Vector3f(Eigen::Map<const Vector3f>(cloud->normals[i].data())) : around[i].normal;
    add_square(point_of(*cloud, i), normal, std::clamp(step, 0.3f * usual, 2.5f * usual), &squares);
    if (!cloud->colours.empty()) squares.colours.insert(squares.colours.end(), 4, cloud->colours[i]);
  }
  cloud->positions = std::move(squares.positions);
  cloud->triangles = std::move(squares.triangles);
  cloud->colours = std::move(squares.colours);
  cloud->normals.clear();
  cloud->texcoords[0].clear();
  return double{usual};
}

}  // namespace cyclorama::scene
