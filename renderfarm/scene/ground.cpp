// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "renderfarm/scene/area.h"

namespace cyclorama {
namespace {

constexpr double kHeadroomM = 0.15;
constexpr double kStepOver = 0.25;  // Of the eye's height: lower things do not stop a visitor,
constexpr double kUneven = 0.4;     // and ground that lies so much lower is still ground.
constexpr double kWallDistanceM = 0.3;
constexpr std::size_t kMostCorners = 512;

/// One bit for each column of cells.
class ColumnSet {
 public:
  ColumnSet(int width, int depth)
      : width_(width), depth_(depth), bits_(static_cast<std::size_t>(width) * static_cast<std::size_t>(depth), false) {}
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int depth() const { return depth_; }
  /// False outside.
  [[nodiscard]] bool has(int x, int z) const {
    return x >= 0 && z >= 0 && x < width_ && z < depth_ && bits_[index_of(x, z)];
  }
  void add(int x, int z) { bits_[index_of(x, z)] = true; }

 private:
  [[nodiscard]] std::size_t index_of(int x, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int width_;
  int depth_;
  std::vector<bool> bits_;
};

bool has_ground(const SpaceGrid& grid, int x, int z, const Standing& standing) {
  const Eigen::Vector3d least(0, standing.floor - kUneven * standing.eye_height_m(), 0);
  const Eigen::Vector3d most(0, standing.floor + kStepOver * standing.eye_height_m(), 0);
  const int last = grid.cell_of(most).y();
  for (Eigen::Vector3i cell(x, grid.cell_of(least).y(), z); cell.y() <= last; ++cell.y()) {
    if (grid.is_solid(cell)) return true;
  }
  return false;
}

/// Columns with ground and room for a body. Scans have small holes: ground beside a column is enough.
ColumnSet free_columns(const SpaceGrid& grid, const Standing& standing) {
  ColumnSet ground(grid.cells().x(), grid.cells().z());
  for (int z = 0; z < ground.depth(); ++z) {
    for (int x = 0; x < ground.width(); ++x) {
      if (has_ground(grid, x, z, standing)) ground.add(x, z);
    }
  }
  ColumnSet free(ground.width(), ground.depth());
  for (int z = 0; z < free.depth(); ++z) {
    for (int x = 0; x < free.width(); ++x) {
      bool near_ground = false;
      for (int i = 0; i < 9; ++i) near_ground = near_ground || ground.has(x + i % 3 - 1, z + i / 3 - 1);
      const Eigen::Vector3d centre = grid.centre_of({x, 0, z});
      if (near_ground && body_fits(grid, centre.x(), centre.z(), standing.floor, standing.eye_height_m()))
        free.add(x, z);
    }
  }
  return free;
}

/// Columns whose neighbours up to `cells` away are free too.
ColumnSet eroded(const ColumnSet& free, int cells) {
  ColumnSet inner(free.width(), free.depth());
  for (int z = 0; z < free.depth(); ++z) {
    for (int x = 0; x < free.width(); ++x) {
      bool clear = true;
      for (int dz = -cells; clear && dz <= cells; ++dz) {
        for (int dx = -cells; clear && dx <= cells; ++dx) clear = free.has(x + dx, z + dz);
      }
      if (clear) inner.add(x, z);
    }
  }
  return inner;
}

ColumnSet reached_from(const ColumnSet& free, int start_x, int start_z) {
  ColumnSet reached(free.width(), free.depth());
  std::vector<std::pair<int, int>> waiting;
  const auto reach = [&](int x, int z) {
    if (!free.has(x, z) || reached.has(x, z)) return;
    reached.add(x, z);
    waiting.emplace_back(x, z);
  };
  reach(start_x, start_z);
  while (!waiting.empty()) {
    const auto [x, z] = waiting.back();
    waiting.pop_back();
    reach(x - 1, z);
    reach(x + 1, z);
    reach(x, z - 1);
    reach(x, z + 1);
  }
  return reached;
}

/// The outer edge as corners of cells, walked so that +x is left with the set on its +z side.
std::vector<Eigen::Vector2i> outer_edge(const ColumnSet& set) {
  Eigen::Vector2i first(0, 0);  // Of all columns the first, by z and then by x: its edge along +x is an outer one.
  while (!set.has(first.x(), first.y())) {
    if (++first.x() == set.width()) first = {0, first.y() + 1};
  }
  // Directions +x, +z, -x, -z. A step from a corner runs between the cell that is in the set and one that is not:
  constexpr std::array<std::array<int, 2>, 4> kStep = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  constexpr std::array<std::array<int, 2>, 4> kIn = {{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
  constexpr std::array<std::array<int, 2>, 4> kOut = {{{0, -1}, {0, 0}, {-1, 0}, {-1, -1}}};
  const auto is_edge = [&](const Eigen::Vector2i& at, std::size_t d) {
    return set.has(at.x() + kIn[d][0], at.y() + kIn[d][1]) && !set.has(at.x() + kOut[d][0], at.y() + kOut[d][1]);
  };
  std::vector<Eigen::Vector2i> corners;
  Eigen::Vector2i at = first;
  std::size_t direction = 0;
  do {
    corners.push_back(at);
    at += Eigen::Vector2i(kStep[direction][0], kStep[direction][1]);
    // Around the same cell first: columns that touch at a corner only are not joined.
    for (const std::size_t turn : {std::size_t{1}, std::size_t{0}, std::size_t{3}}) {
      if (!is_edge(at, (direction + turn) % 4)) continue;
      direction = (direction + turn) % 4;
      break;
    }
  } while (at != first || direction != 0);
  return corners;
}

double distance_to_line(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d edge = b - a;
  const double t = edge.squaredNorm() > 0.0 ? std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * edge).norm();
}

/// Douglas and Peucker's simplification of a closed line: no corner that is left out lies farther than `tolerance`
/// away.
std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& corners, double tolerance) {
  const std::size_t n = corners.size();
  std::vector<bool> kept(n, false);
  std::size_t opposite = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if ((corners[i] - corners[0]).norm() > (corners[opposite] - corners[0]).norm()) opposite = i;
  }
  kept[0] = kept[opposite] = true;
  std::vector<std::pair<std::size_t, std::size_t>> waiting = {{0, opposite}, {opposite, n}};
  while (!waiting.empty()) {
    const auto [begin, end] = waiting.back();
    waiting.pop_back();
    double farthest = tolerance;
    std::size_t at = begin;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double distance = distance_to_line(corners[i], corners[begin], corners[end % n]);
      if (distance > farthest) farthest = distance, at = i;
    }
    if (at == begin) continue;
    kept[at] = true;
    waiting.emplace_back(begin, at);
    waiting.emplace_back(at, end);
  }
  std::vector<Eigen::Vector2d> simple;
  for (std::size_t i = 0; i < n; ++i) {
    if (kept[i]) simple.push_back(corners[i]);
  }
  return simple;
}

}  // namespace

bool body_fits(const SpaceGrid& grid, double x, double z, double floor, double eye_height_m) {
  Eigen::Vector3i cell = grid.cell_of({x, floor + kStepOver * eye_height_m, z});
  const int above_floor = grid.cell_of({x, floor, z}).y() + 1;
  const int last = grid.cell_of({x, floor + eye_height_m + kHeadroomM, z}).y();
  for (cell.y() = std::max(cell.y(), above_floor); cell.y() <= last; ++cell.y()) {
    if (grid.is_solid(cell)) return false;
  }
  return true;
}

std::vector<Eigen::Vector2d> walkable_outline(const SpaceGrid& grid, const Standing& standing) {
  const Eigen::Vector3i start = grid.cell_of(standing.eye);
  const ColumnSet free = free_columns(grid, standing);
  if (!free.has(start.x(), start.z())) return {};
  // Near to a wall the distance from walls is what can be had.
  int distance = std::max(1, static_cast<int>(std::ceil(kWallDistanceM / grid.cell_m())));
  ColumnSet roomy = eroded(free, distance);
  while (!roomy.has(start.x(), start.z())) roomy = eroded(free, --distance);
  std::vector<Eigen::Vector2d> corners;
  const Eigen::Vector3d origin = grid.centre_of({0, 0, 0}).array() - 0.5 * grid.cell_m();
  for (const Eigen::Vector2i& corner : outer_edge(reached_from(roomy, start.x(), start.z()))) {
    corners.emplace_back(origin.x() + corner.x() * grid.cell_m(), origin.z() + corner.y() * grid.cell_m());
  }
  // Stairs of cells become slopes, unless the eye stands in one: below half a cell, its cell's middle stays inside.
  for (double tolerance = 0.75; tolerance < 64.0; tolerance *= 2.0) {
    const std::vector<Eigen::Vector2d> simple = simplified(corners, tolerance * grid.cell_m());
    if (simple.size() <= kMostCorners && is_inside(simple, {standing.eye.x(), standing.eye.z()})) return simple;
  }
  std::vector<Eigen::Vector2d> exact = simplified(corners, 0.4 * grid.cell_m());
  if (exact.size() > kMostCorners || !is_inside(exact, {standing.eye.x(), standing.eye.z()})) exact.clear();
  return exact;
}

}  // namespace cyclorama
