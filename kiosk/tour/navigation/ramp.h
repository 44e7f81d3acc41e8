// SPDX-License-Identifier: Apache-2.0
/// A speed that follows a wish with limited acceleration and limited jerk.
///
///   speed         ╭──────── wanted          The acceleration may be no more than what can be ramped down again before
///               ╭╯                          the wanted speed is reached: a²/(2j) <= what is left. So it never
///   ──────────╯                             overshoots, whatever the length of the steps.
///   acceleration ╱▔▔╲____
#pragma once

namespace cyclorama {

/// Per second; both above zero.
struct RampLimits {
  double acceleration = 1.0;
  double jerk = 10.0;
};

/// A value; any unit per second, and that per second.
struct Ramp {
  double speed = 0.0;
  double acceleration = 0.0;
  friend bool operator==(const Ramp&, const Ramp&) = default;
};

/// `seconds` later; not below zero. Comes to rest at `wanted` exactly.
[[nodiscard]] Ramp ramped(const Ramp& ramp, double wanted, double seconds, const RampLimits& limits);

/// The longest that it takes from any state within +-speed to rest: an acceleration ends, then from full speed down.
[[nodiscard]] constexpr double longest_stop_s(double speed, const RampLimits& limits) {
  return speed / limits.acceleration + 2.0 * limits.acceleration / limits.jerk;
}

}  // namespace cyclorama
