// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::camera_calibration {

/// Returns the inner corners of a chessboard, row by row, to some hundredths of a pixel; the first pixel's centre is at
/// (0.5, 0.5). The first corner is ambiguous: a board turned by half a turn may give the opposite order.
///
/// Uses OpenCV's findChessboardCornersSB (Duda and Frese 2018), or else findChessboardCorners and cornerSubPix.
///
/// Errors: kInvalidArgument for fewer than 3 corners each way; kNotFound, with advice, if there is no such board;
/// kSystem with OpenCV's own message.
Result<std::vector<Eigen::Vector2d>> find_chessboard(const GreyImage& photo, int columns, int rows);

/// Refines each corner to where four squares meet, from the grey levels within `half_px` each way (OpenCV's
/// cornerSubPix). A corner that leaves its window, or has no such point, becomes NaN. Errors: those of
/// find_chessboard().
Result<std::vector<Eigen::Vector2d>> sharpened_corners(const GreyImage& photo, std::vector<Eigen::Vector2d> corners,
                                                       int half_px);

}  // namespace cyclorama::camera_calibration
