// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace cyclorama::camera_calibration {

/// One picture of a flat board: where its corners are on the board, and where the camera sees them. Lists of one
/// length.
struct LensView {
  std::string name;  ///< Of the picture, for who reads errors.
  std::vector<Eigen::Vector2d> board_m;
  std::vector<Eigen::Vector2d> camera_px;  ///< First pixel's centre at (0.5, 0.5).
};

}  // namespace cyclorama::camera_calibration
