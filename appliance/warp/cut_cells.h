// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "appliance/warp/warp_mesh.h"

namespace cyclorama::warp {

/// The cells of a regular grid, cut along lines through the whole picture. A line cuts neighbouring cells at exactly
/// the same points, so that there are no gaps between them.
struct CutGrid {
  std::vector<Eigen::Vector2d> positions;  ///< Corners of the grid, row by row, then the cuts' vertices.
  std::vector<CutCell> cuts;               ///< Sorted by ascending cell.
};
[[nodiscard]] CutGrid cut_grid(const Eigen::Vector2d& size_px, int cells_x, int cells_y,
                               const std::vector<Eigen::Hyperplane<double, 2>>& lines);

}  // namespace cyclorama::warp
