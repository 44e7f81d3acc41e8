// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "appliance/warp/warp_mesh.h"

namespace cyclorama::warp {

/// A regular grid's cells, cut along lines that go through the whole picture: the same line cuts neighbours at the same
/// place, to the last bit, so that nothing shows between them.
struct CutGrid {
  std::vector<Eigen::Vector2d> positions;  ///< Of the grid's corners, row by row, then of what the cuts added.
  std::vector<CutCell> cuts;               ///< By rising cell.
};
[[nodiscard]] CutGrid cut_grid(const Eigen::Vector2d& size_px, int cells_x, int cells_y,
                               const std::vector<Eigen::Hyperplane<double, 2>>& lines);

}  // namespace cyclorama::warp
