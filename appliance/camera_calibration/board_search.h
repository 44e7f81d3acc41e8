// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/camera_calibration/lens_view.h"
#include "appliance/tags/tag_detector.h"
#include "common/base/result.h"
#include "common/board/tag_board.h"

namespace cyclorama::camera_calibration {

/// Kind of board to search for.
struct BoardKind {
  TagBoard tags{};
  /// True for a board without tags, all of which must be visible; `tags` gives its columns and rows, in squares.
  bool is_chessboard = false;
};

/// Returns a detector for find_board(). Errors: those of TagDetector::create().
Result<tags::TagDetector> make_board_detector();

/// Finds the corners of a board in one picture. With tags, a part of the board suffices: each corner is predicted from
/// the tags around it, and refined to the point where four squares meet. Errors: kNotFound, with the remedy, if no
/// board is found, or fewer than kMinCorners of its corners; otherwise those of find_chessboard().
Result<LensView> find_board(const GreyImage& picture, const BoardKind& kind, tags::TagDetector* detector);

inline constexpr std::size_t kMinCorners = 8;

}  // namespace cyclorama::camera_calibration
