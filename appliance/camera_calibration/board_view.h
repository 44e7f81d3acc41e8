// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/rigid_transform.h"

namespace cyclorama::frame {
struct Board;  ///< Frame of a chessboard: origin at the first inner corner, x along the rows, y along the columns.
}  // namespace cyclorama::frame

namespace cyclorama::camera_calibration {

/// Corners of a flat board in one pose, seen by the camera and lit by the projector: three lists of equal length.
struct BoardView {
  std::vector<Eigen::Vector2d> board_m;
  std::vector<Eigen::Vector2d> camera_px;     ///< First pixel's centre at (0.5, 0.5).
  std::vector<Eigen::Vector2d> projector_px;  ///< First pixel's centre at (0.5, 0.5).
};

/// Returns the inner corners of a chessboard, row by row.
[[nodiscard]] inline std::vector<Eigen::Vector2d> chessboard_corners(int columns, int rows, double square_m) {
  std::vector<Eigen::Vector2d> corners;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) corners.emplace_back(square_m * x, square_m * y);
  }
  return corners;
}

}  // namespace cyclorama::camera_calibration
