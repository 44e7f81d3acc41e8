// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/camera_calibration/lens_view.h"
#include "appliance/tags/tag_detector.h"
#include "common/base/result.h"
#include "common/board/tag_board.h"

namespace cyclorama::camera_calibration {

/// What to look for in pictures.
struct BoardKind {
  TagBoard tags{};
  bool is_chessboard = false;  ///< Without tags: all of it must be seen; columns and rows count squares as well.
};

/// Errors as TagDetector::create().
Result<tags::TagDetector> make_board_detector();

/// The corners of a board in one picture. With tags a part of the board is enough: tags are read, each corner is
/// expected where the tags around it say, and moved to where four squares meet.
///
/// kNotFound  no such board, or fewer than kMinCorners of it: says what to look at.  Others as find_chessboard().
Result<LensView> find_board(const GreyImage& picture, const BoardKind& kind, tags::TagDetector* detector);

inline constexpr std::size_t kMinCorners = 8;

}  // namespace cyclorama::camera_calibration
