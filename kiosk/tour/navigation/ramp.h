// SPDX-License-Identifier: Apache-2.0
/// A speed that follows a command with limited acceleration and limited jerk.
///
///   speed         ╭──────── wanted          The acceleration is bounded by what can be ramped down again before the
///               ╭╯                          wanted speed is reached: a²/(2j) <= remaining difference. So the speed
///   ──────────╯                             never overshoots, whatever the length of the steps.
///   acceleration ╱▔▔╲____
#pragma once

namespace cyclorama::tour {

/// Limits per second and per second squared; both positive.
struct RampLimits {
  double acceleration = 1.0;
  double jerk = 10.0;
};

/// A speed in any unit per second, and its acceleration. A value.
struct Ramp {
  double speed = 0.0;
  double acceleration = 0.0;
  friend bool operator==(const Ramp&, const Ramp&) = default;
};

/// Returns the ramp after `seconds`; unchanged if `seconds` is not positive. Reaches `wanted` exactly.
[[nodiscard]] Ramp ramped(const Ramp& ramp, double wanted, double seconds, const RampLimits& limits);

/// Returns the maximum time from any state within +-speed to rest: an acceleration ends, then full speed ramps down.
[[nodiscard]] constexpr double max_stop_s(double speed, const RampLimits& limits) {
  return speed / limits.acceleration + 2.0 * limits.acceleration / limits.jerk;
}

}  // namespace cyclorama::tour
