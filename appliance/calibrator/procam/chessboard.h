// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// The inner corners of a chessboard, row by row, to some hundredths of a pixel; the first pixel's centre is (0.5,
/// 0.5). Found by OpenCV (findChessboardCorners, then cornerSubPix with a window of a third of a square, at most 11
/// pixels). kInvalidArgument  fewer than 3 corners each way. kNotFound  no such board, with what to look at. kSystem
/// OpenCV's own words.
Result<std::vector<Eigen::Vector2d>> find_chessboard(const GreyImage& photo, int columns, int rows);

}  // namespace cyclorama
