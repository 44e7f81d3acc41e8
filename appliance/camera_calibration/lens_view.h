// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace cyclorama::camera_calibration {

/// One picture of a flat board: the corners' positions on the board and in the picture. Lists of equal length.
struct LensView {
  std::string name;  ///< Name of the picture, for error messages.
  std::vector<Eigen::Vector2d> board_m;
  std::vector<Eigen::Vector2d> camera_px;  ///< First pixel's centre at (0.5, 0.5).
};

}  // namespace cyclorama::camera_calibration
