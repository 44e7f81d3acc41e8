// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/yaw_shift.h"

#include <algorithm>
#include <cmath>

namespace cyclorama {

YawShift yaw_shift(const Panorama& picture, double picture_heading_rad, double heading_now_rad, double shown_span_rad) {
  const double turned = wrapped_angle(heading_now_rad - picture_heading_rad);
  if (is_whole_turn(picture)) return {turned, false};
  const double reach = std::max(0.0, 0.5 * (picture.azimuth_span_rad - shown_span_rad));
  return {std::clamp(turned, -reach, reach), std::abs(turned) > reach};
}

}  // namespace cyclorama
