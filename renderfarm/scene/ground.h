// SPDX-License-Identifier: Apache-2.0
/// Ground that a visitor can walk on, derived from a SpaceGrid.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "renderfarm/scene/space_grid.h"

namespace cyclorama::scene {

/// Position of an eye, and height of the ground below the eye.
struct Standing {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double floor = 0.0;
  [[nodiscard]] double eye_height_m() const { return eye.y() - floor; }
};

/// Returns true if a body that stands on `floor` fits into the column of cells at (x, z). Obstacles that are low enough
/// to step over do not count.
[[nodiscard]] bool body_fits(const SpaceGrid& grid, double x, double z, double floor, double eye_height_m);

/// Returns the area of all ground that walkable_outline() encloses, without the obstacles inside.
[[nodiscard]] double walkable_area_m2(const SpaceGrid& grid, const Standing& standing);

/// Returns the outline of all ground that can be reached from the visitor's position, at some distance from obstacles:
/// at most 512 (x, z) corners, with the eye inside. Obstacles inside the outline, such as pillars, are not cut out.
/// Empty if the visitor cannot take a step.
[[nodiscard]] std::vector<Eigen::Vector2d> walkable_outline(const SpaceGrid& grid, const Standing& standing);

}  // namespace cyclorama::scene
