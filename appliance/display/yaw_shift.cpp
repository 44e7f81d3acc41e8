// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/yaw_shift.h"

#include <algorithm>
#include <cmath>

namespace cyclorama {

YawShift yaw_shift(double picture_heading_rad, double heading_now_rad, double reach_rad) {
  const double turned = wrapped_angle(heading_now_rad - picture_heading_rad);
  return {std::clamp(turned, -reach_rad, reach_rad), std::abs(turned) > reach_rad};
}

}  // namespace cyclorama
