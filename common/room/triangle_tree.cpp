// SPDX-License-Identifier: Apache-2.0
#include "common/room/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cyclorama {
namespace {

constexpr std::uint32_t kMaxLeafTriangles = 4;
constexpr double kMinDistance = 1e-9;  // In units of the direction; excludes the ray's origin.
// Tolerance relative to a triangle's size, so that rounding leaves no gap between neighbours.
constexpr double kSeam = 1e-9;
constexpr std::size_t kDeepest = 64;

/// Intersects a ray with a triangle. Source: Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection",
/// JGT 2(1), 1997.
std::optional<double> meet(const TriangleCorners& t, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d ab = t[1] - t[0];
  const Eigen::Vector3d ac = t[2] - t[0];
  const Eigen::Vector3d across = direction.cross(ac);
  const double facing = ab.dot(across);
  if (!(facing > 0.0)) return std::nullopt;
  const Eigen::Vector3d from_a = origin - t[0];
  const double b = from_a.dot(across) / facing;
  if (!(b >= -kSeam && b <= 1.0 + kSeam)) return std::nullopt;
  const Eigen::Vector3d q = from_a.cross(ab);
  const double c = direction.dot(q) / facing;
  if (!(c >= -kSeam && b + c <= 1.0 + kSeam)) return std::nullopt;
  const double along = ac.dot(q) / facing;
  if (!(along > kMinDistance && along < std::numeric_limits<double>::infinity())) return std::nullopt;
  return along;
}

/// True if a ray enters a box before `farthest`.
bool enters(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& inverse,
            double farthest) {
  double near = 0.0;
  double far = farthest;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.min()[axis] - origin[axis]) * inverse[axis];
    const double b = (box.max()[axis] - origin[axis]) * inverse[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far * (1.0 + 1e-12);
}

}  // namespace

TriangleTree::TriangleTree(std::vector<TriangleCorners> triangles) : triangles_(std::move(triangles)) {
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

void TriangleTree::build(std::uint32_t first, std::uint32_t end) {
  const std::size_t index = nodes_.size();
  nodes_.emplace_back();
  Eigen::AlignedBox3d middles;
  for (std::uint32_t i = first; i < end; ++i) {
    const TriangleCorners& t = triangles_[order_[i]];
    for (const Eigen::Vector3d& corner : t) nodes_[index].box.extend(corner);
    middles.extend(t[0] + t[1] + t[2]);
  }
  // Adds a tolerance for rounding, so that rays also enter flat boxes.
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(1e-9 * (1.0 + nodes_[index].box.sizes().maxCoeff()));
  nodes_[index].box.min() -= margin;
  nodes_[index].box.max() += margin;
  if (end - first <= kMaxLeafTriangles) {
    nodes_[index].first = first;
    nodes_[index].count = end - first;
    return;
  }
  int axis = 0;
  middles.sizes().maxCoeff(&axis);
  const auto middle_of = [&](std::uint32_t t) {
    return triangles_[t][0][axis] + triangles_[t][1][axis] + triangles_[t][2][axis];
  };
  const std::uint32_t half = first + (end - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return middle_of(a) < middle_of(b); });
  build(first, half);
  nodes_[index].first = static_cast<std::uint32_t>(nodes_.size());
  build(half, end);
}

std::optional<TriangleTree::Hit> TriangleTree::hit(const Eigen::Vector3d& origin,
                                                   const Eigen::Vector3d& direction) const {
  if (nodes_.empty() || !origin.allFinite() || !direction.allFinite()) return std::nullopt;
  // Avoids infinity, which multiplied by 0 is NaN.
  const auto inverse_of = [](double d) { return 1.0 / (std::abs(d) < 1e-300 ? 1e-300 : d); };
  const Eigen::Vector3d inverse(inverse_of(direction.x()), inverse_of(direction.y()), inverse_of(direction.z()));
  std::array<std::uint32_t, kDeepest> waiting{};
  std::size_t depth = 0;
  waiting[depth++] = 0;
  Hit best{0, std::numeric_limits<double>::infinity()};
  while (depth > 0) {
    const std::uint32_t index = waiting[--depth];
    const Node& node = nodes_[index];
    if (!enters(node.box, origin, inverse, best.along)) continue;
    if (node.count == 0) {
      waiting[depth++] = node.first;
      waiting[depth++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto along = meet(triangles_[order_[i]], origin, direction);
      if (along && *along < best.along) best = {order_[i], *along};
    }
  }
  if (!std::isfinite(best.along)) return std::nullopt;
  return best;
}

}  // namespace cyclorama
