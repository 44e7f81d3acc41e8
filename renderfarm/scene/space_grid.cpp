// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/space_grid.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::scene {
namespace {

constexpr double kCellsAlongLongestAxis = 96.0;
constexpr std::size_t kMarksLimit = 40'000'000;  // So many marks take about a second.
constexpr double kMaxSteps = 240.0;              // Longer than any triangle that lies within the grid.
constexpr double kTrianglesPerCellFace = 64.0;   // More triangles of one mesh add no information about a cell.

Eigen::Vector3d corner_of(const Mesh& mesh, const Eigen::Affine3d& T, std::uint32_t index) {
  const auto& p = mesh.positions[index];
  return T * (mesh.origin + Eigen::Vector3d(double{p[0]}, double{p[1]}, double{p[2]}));
}

/// Returns the diagonal of the mesh's box in the scene.
double diagonal_of(const Mesh& mesh, const Eigen::Affine3d& T) {
  Eigen::AlignedBox3f box;
  for (const auto& p : mesh.positions) box.extend(Eigen::Vector3f(p[0], p[1], p[2]));
  return double{box.diagonal().norm()} * std::cbrt(std::abs(T.linear().determinant()));
}

}  // namespace

SpaceGrid::SpaceGrid(const Model& model, const Eigen::AlignedBox3d& bounds) : marks_left_(kMarksLimit) {
  cell_m_ = std::max(bounds.sizes().maxCoeff() / kCellsAlongLongestAxis, 1e-9);
  min_ = bounds.min().array() - 0.5 * cell_m_;
  cells_ = (bounds.sizes() / cell_m_).array().floor().cast<int>() + 2;
  data_.resize(static_cast<std::size_t>(cells_.cast<std::int64_t>().prod()));
  for (const Instance& instance : model.instances) {
    mark_instance(model.meshes[static_cast<std::size_t>(instance.mesh)], instance);
  }
}

std::size_t SpaceGrid::index_of(const Eigen::Vector3i& cell) const {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  return (at(cell.z()) * at(cells_.y()) + at(cell.y())) * at(cells_.x()) + at(cell.x());
}

void SpaceGrid::mark(const Eigen::Vector3d& p, const Eigen::Vector3f& normal) {
  const Eigen::Vector3i cell = cell_of(p);
  if (!contains(cell)) return;  // Rounding may place a point outside at the very edge.
  Cell& marked = data_[index_of(cell)];
  marked.top = std::max(marked.top, static_cast<float>(p.y()));
  marked.facing += normal;
}

bool SpaceGrid::is_outside(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) const {
  const Eigen::Array3d max = min_.array() + cell_m_ * cells_.cast<double>().array();
  return (a.cwiseMin(b).cwiseMin(c).array() > max).any() || (a.cwiseMax(b).cwiseMax(c).array() < min_.array()).any();
}

void SpaceGrid::mark_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  if (is_outside(a, b, c)) return;
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d v = c - a;
  const Eigen::Vector3f normal = u.cross(v).normalized().cast<float>();
  const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (c - b).squaredNorm()}));
  if (longest > 0.7 * cell_m_ * kMaxSteps) {  // It reaches far out of a grid of a part: only what is inside counts.
    const Eigen::Vector3d ab = 0.5 * (a + b);
    const Eigen::Vector3d bc = 0.5 * (b + c);
    const Eigen::Vector3d ca = 0.5 * (c + a);
    mark_triangle(a, ab, ca);
    mark_triangle(ab, b, bc);
    mark_triangle(ca, bc, c);
    mark_triangle(ab, bc, ca);
    return;
  }
  const auto steps = static_cast<std::size_t>(longest / (0.7 * cell_m_)) + 1;
  const std::size_t marks = steps * (steps + 1) / 2;
  if (steps == 1 || marks > marks_left_) return mark((a + b + c) / 3.0, normal);
  marks_left_ -= marks;
  for (std::size_t i = 0; i < steps; ++i) {
    for (std::size_t k = 0; i + k < steps; ++k) {
      const double s = (static_cast<double>(i) + 1.0 / 3.0) / static_cast<double>(steps);
      const double t = (static_cast<double>(k) + 1.0 / 3.0) / static_cast<double>(steps);
      mark(a + s * u + t * v, normal);
    }
  }
}

void SpaceGrid::mark_instance(const Mesh& mesh, const Instance& instance) {
  const Eigen::Affine3d& T = instance.T_model_mesh;
  const double across = diagonal_of(mesh, T) / cell_m_ + 1.0;
  const double enough = kTrianglesPerCellFace * across * across;
  const auto stride = static_cast<std::size_t>(std::max(1.0, static_cast<double>(mesh.triangles.size()) / enough));
  for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const auto& t = mesh.triangles[i];
    mark_triangle(corner_of(mesh, T, t[0]), corner_of(mesh, T, t[1]), corner_of(mesh, T, t[2]));
  }
}

SpaceGrid::Ray SpaceGrid::cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
  const Eigen::Vector3i first = cell_of(from);
  const double step = 0.5 * cell_m_;
  Ray ray;
  for (int i = 1;; ++i) {
    ray.length_m = i * step;
    const Eigen::Vector3i cell = cell_of(from + ray.length_m * direction);
    if (!contains(cell)) return ray;
    if (cell == first || !is_solid(cell)) continue;
    ray.hits = true;
    // The normals of a sheet that is folded within the cell cancel, and the ray then counts as hitting the front.
    ray.from_behind = double{at(cell).facing.normalized().dot(direction.cast<float>())} > 0.1;
    return ray;
  }
}

}  // namespace cyclorama::scene
