// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/ramp.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::tour {

Ramp ramped(const Ramp& ramp, double wanted, double seconds, const RampLimits& limits) {
  if (!(seconds > 0.0)) return ramp;
  constexpr double kSettled = 1e-6;  // Speed difference that is invisible: a micrometre per second.
  const double left = wanted - ramp.speed;
  const double change = limits.jerk * seconds;
  if (std::abs(left) <= kSettled &&
      std::abs(ramp.acceleration) <= std::max(change, std::sqrt(2 * limits.jerk * kSettled)))
    return {wanted, 0.0};
  // The maximum a with a²/(2j) + a·seconds <= |left|: after this step it can still be ramped down with any step length.
  const double max = std::sqrt(change * change + 2.0 * limits.jerk * std::abs(left)) - change;
  const double aim = std::copysign(std::min(max, limits.acceleration), left);
  const double acceleration = ramp.acceleration + std::clamp(aim - ramp.acceleration, -change, change);
  return {ramp.speed + acceleration * seconds, acceleration};
}

}  // namespace cyclorama::tour
