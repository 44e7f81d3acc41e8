// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera_calibration {

/// The inner corners of a chessboard, row by row, to some hundredths of a pixel; the first pixel's centre is at
/// (0.5, 0.5). Which corner is the first is not said: a board turned half around may give them in the opposite order.
///
/// Found by OpenCV: findChessboardCornersSB (Duda and Frese 2018), or else findChessboardCorners and cornerSubPix.
///
/// kInvalidArgument  fewer than 3 corners each way.     kNotFound  no such board, with what to look at.
/// kSystem           OpenCV's own words.
Result<std::vector<Eigen::Vector2d>> find_chessboard(const GreyImage& photo, int columns, int rows);

/// Moves each corner where four squares meet onto it, by the grey levels within `half_px` each way (OpenCV's
/// cornerSubPix). One that leaves its window, or has no such place, is NaN. Errors as find_chessboard().
Result<std::vector<Eigen::Vector2d>> sharpened_corners(const GreyImage& photo, std::vector<Eigen::Vector2d> corners,
                                                       int half_px);

}  // namespace cyclorama::camera_calibration
