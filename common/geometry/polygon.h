// SPDX-License-Identifier: Apache-2.0
/// Triangulation of polygons.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cyclorama {

/// Appends the triangles of one polygon, as indices into `corners`, in the polygon's winding. Convex polygons, and
/// those of more than 256 corners, become a fan; from other polygons, ears are cut (usually O(n^2)). A polygon that
/// crosses itself or has no area yields n - 2 arbitrary triangles. Fewer than three corners yield none. Reentrant.
void triangulate(std::span<const Eigen::Vector3d> corners, std::vector<std::array<std::uint32_t, 3>>* triangles);

}  // namespace cyclorama
