// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/yaw_shift.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::display {

YawShift yaw_shift(double picture_heading_rad, double heading_now_rad, double turn_limit_rad) {
  const double turned = wrapped_angle(heading_now_rad - picture_heading_rad);
  return {std::clamp(turned, -turn_limit_rad, turn_limit_rad), std::abs(turned) > turn_limit_rad};
}

}  // namespace cyclorama::display
