// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera_calibration {

/// Returns the inner corners of a chessboard, row by row, accurate to some hundredths of a pixel; the first pixel's
/// centre is at (0.5, 0.5). The order is ambiguous: a board that is turned by 180 degrees may give the opposite order.
///
/// Uses OpenCV's findChessboardCornersSB (Duda and Frese 2018), or else findChessboardCorners and cornerSubPix.
///
/// Errors: kInvalidArgument for fewer than 3 corners each way; kNotFound, with the remedy, if the board is not found;
/// kSystem with OpenCV's message.
Result<std::vector<Eigen::Vector2d>> find_chessboard(const GreyImage& photo, int columns, int rows);

/// Refines each corner to the point where four squares meet, from the grey levels within `half_px` each way (OpenCV's
/// cornerSubPix). A corner that moves by nearly `half_px`, or around which the picture has no contrast, becomes NaN.
/// Errors: kInvalidArgument for an empty picture or `half_px` below 2; kSystem with OpenCV's message.
Result<std::vector<Eigen::Vector2d>> sharpened_corners(const GreyImage& photo, std::vector<Eigen::Vector2d> corners,
                                                       int half_px);

}  // namespace cyclorama::camera_calibration
