// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/camera_calibration/lens_view.h"
#include "appliance/tags/tag_detector.h"
#include "common/base/result.h"
#include "common/board/tag_board.h"

namespace cyclorama::camera_calibration {

/// Description of the board to search for.
struct BoardKind {
  TagBoard tags{};
  /// A board without tags: all of it must be visible; columns and rows still count squares.
  bool is_chessboard = false;
};

/// Errors: those of TagDetector::create().
Result<tags::TagDetector> make_board_detector();

/// Finds the corners of a board in one picture. With tags, part of the board suffices: tags are detected, each corner
/// is predicted from the tags around it and refined to where four squares meet.
/// Errors: kNotFound, with advice, if there is no such board or fewer than kMinCorners of its corners are found;
/// otherwise those of find_chessboard().
Result<LensView> find_board(const GreyImage& picture, const BoardKind& kind, tags::TagDetector* detector);

inline constexpr std::size_t kMinCorners = 8;

}  // namespace cyclorama::camera_calibration
