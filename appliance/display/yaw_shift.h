// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/geometry/panorama.h"

namespace cyclorama {

struct YawShift {
  double angle_rad = 0.0;      ///< How far the visitor has turned to the right since the picture was asked for.
  bool is_past_guard = false;  ///< The visitor turned farther than the guard band reaches; `angle_rad` stops there.
};

/// Yaw is a shift: what a picture that was made for one heading must be moved by to be right for another one, limited
/// so that the wall, which shows `shown_span_rad` of it, never looks beyond the picture's edge.
[[nodiscard]] YawShift yaw_shift(const Panorama& picture, double picture_heading_rad, double heading_now_rad,
                                 double shown_span_rad);

}  // namespace cyclorama
