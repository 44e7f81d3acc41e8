// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/polygon.h"

#include <Eigen/Geometry>
#include <numeric>

namespace cyclorama {
namespace {

constexpr std::size_t kEarsLimit = 256;

using Flat = std::vector<Eigen::Vector2d>;

/// Returns twice the signed area of the triangle.
double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Projects the polygon along its normal (Newell's method, so that the corners need not lie in one plane). The result
/// runs counter-clockwise.
Flat flatten(std::span<const Eigen::Vector3d> corners) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = corners[i] - corners[0];
    const Eigen::Vector3d b = corners[(i + 1) % corners.size()] - corners[0];
    normal += a.cross(b);
  }
  int drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const int u = (drop + 1) % 3;
  const int v = (drop + 2) % 3;
  const bool mirrored = normal[drop] < 0.0;
  Flat flat;
  flat.reserve(corners.size());
  for (const Eigen::Vector3d& corner : corners) {
    const Eigen::Vector3d p = corner - corners[0];
    flat.emplace_back(mirrored ? p[v] : p[u], mirrored ? p[u] : p[v]);
  }
  return flat;
}

bool is_convex(const Flat& flat) {
  const std::size_t n = flat.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0.0) return false;
  }
  return true;
}

bool is_ear(const Flat& flat, const std::vector<std::uint32_t>& left, std::size_t at) {
  const std::size_t n = left.size();
  const Eigen::Vector2d& a = flat[left[(at + n - 1) % n]];
  const Eigen::Vector2d& b = flat[left[at]];
  const Eigen::Vector2d& c = flat[left[(at + 1) % n]];
  if (!(turn(a, b, c) > 0.0)) return false;
  for (const std::uint32_t other : left) {
    const Eigen::Vector2d& p = flat[other];
    // A hole is often joined by a doubled edge: corners at the position of one of the ear's corners do not invalidate
    // it.
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
  }
  return true;
}

}  // namespace

void triangulate(std::span<const Eigen::Vector3d> corners, std::vector<std::array<std::uint32_t, 3>>* triangles) {
  const std::size_t n = corners.size();
  if (n < 3) return;
  const auto fan = [&] {
    for (std::uint32_t i = 2; i < n; ++i) triangles->push_back({0, i - 1, i});
  };
  if (n == 3 || n > kEarsLimit) return fan();
  const Flat flat = flatten(corners);
  if (is_convex(flat)) return fan();

  std::vector<std::uint32_t> left(n);
  std::iota(left.begin(), left.end(), 0u);
  std::size_t at = 0;
  while (left.size() > 3) {
    const std::size_t m = left.size();
    std::size_t tried = 0;
    while (tried < m && !is_ear(flat, left, at % m)) ++tried, ++at;
    if (tried == m) break;  // The polygon crosses itself or has no area.
    at %= m;
    triangles->push_back({left[(at + m - 1) % m], left[at], left[(at + 1) % m]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
  }
  for (std::size_t i = 2; i < left.size(); ++i) triangles->push_back({left[0], left[i - 1], left[i]});
}

}  // namespace cyclorama
