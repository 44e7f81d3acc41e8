// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/panorama.h"

namespace cyclorama::display {

struct YawShift {
  double angle_rad = 0.0;      ///< Turn of the visitor to the right since the view was requested.
  bool is_past_guard = false;  ///< The visitor turned farther than the picture extends; `angle_rad` stops there.
};

/// Returns the turn with which a picture for one heading is shown for another (a panorama is shifted), limited to
/// `turn_limit_rad` either way (shown_parts.h), so that the wall never shows anything beyond the picture.
[[nodiscard]] YawShift yaw_shift(double picture_heading_rad, double heading_now_rad, double turn_limit_rad);

}  // namespace cyclorama::display
