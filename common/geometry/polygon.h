// SPDX-License-Identifier: Apache-2.0
/// Polygons into triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cyclorama {

/// Appends the triangles of one polygon, as places in `corners`, in the polygon's winding. Convex polygons become a
/// fan; others have their ears cut (O(n^2) as a rule), unless they have more than 256 corners, which become a fan as
/// well. A polygon that crosses itself or has no area becomes something with n - 2 triangles. Fewer than three corners
/// give none. Reentrant.
void triangulate(std::span<const Eigen::Vector3d> corners, std::vector<std::array<std::uint32_t, 3>>* triangles);

}  // namespace cyclorama
