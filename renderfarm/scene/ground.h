// SPDX-License-Identifier: Apache-2.0
/// Ground that a visitor can walk on, derived from a SpaceGrid.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "renderfarm/scene/space_grid.h"

namespace cyclorama::scene {

/// Position of an eye, and the height of the ground below it.
struct Standing {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double floor = 0.0;
  [[nodiscard]] double eye_height_m() const { return eye.y() - floor; }
};

/// True if the column of cells at (x, z) is free for a body standing on `floor`. Obstacles low enough to step over do
/// not count.
[[nodiscard]] bool body_fits(const SpaceGrid& grid, double x, double z, double floor, double eye_height_m);

/// Outline of all ground that can be reached from the visitor's position, at some distance from obstacles: (x, z)
/// corners, at most 512, the eye inside. Columns within it are not cut out. Empty if the visitor cannot take a step.
[[nodiscard]] std::vector<Eigen::Vector2d> walkable_outline(const SpaceGrid& grid, const Standing& standing);

}  // namespace cyclorama::scene
