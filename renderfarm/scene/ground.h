// SPDX-License-Identifier: Apache-2.0
/// Ground that a visitor can walk on, as a SpaceGrid shows it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "renderfarm/scene/space_grid.h"

namespace cyclorama {

/// Where an eye is, and the height of the ground below it.
struct Standing {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double floor = 0.0;
  [[nodiscard]] double eye_height_m() const { return eye.y() - floor; }
};

/// Is the height of a body free over `floor`, in the column of cells at (x, z)? What a visitor steps over does not
/// count.
[[nodiscard]] bool body_fits(const SpaceGrid& grid, double x, double z, double floor, double eye_height_m);

/// The outline of all ground that can be reached from where the visitor stands, with some distance from what is in the
/// way: (x, z) corners, at most 512, the eye inside. Columns within it are not cut out. Empty when the visitor cannot
/// take a step.
[[nodiscard]] std::vector<Eigen::Vector2d> walkable_outline(const SpaceGrid& grid, const Standing& standing);

}  // namespace cyclorama
