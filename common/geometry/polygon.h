// SPDX-License-Identifier: Apache-2.0
/// Triangulation of polygons.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cyclorama {

/// Appends the triangles of one polygon, as indices into `corners`, in the polygon's winding. Convex polygons become a
/// fan; for others, ears are cut (usually O(n^2)), unless they have more than 256 corners, in which case they become a
/// fan as well. A polygon that crosses itself or has no area yields n - 2 arbitrary triangles. Fewer than three corners
/// yield none. Reentrant.
void triangulate(std::span<const Eigen::Vector3d> corners, std::vector<std::array<std::uint32_t, 3>>* triangles);

}  // namespace cyclorama
