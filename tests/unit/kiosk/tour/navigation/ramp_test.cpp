// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/ramp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace cyclorama::tour {
namespace {

constexpr RampLimits kLimits{2.2, 18.0};

TEST(Ramp, reaches_the_wanted_speed_exactly_in_the_minimum_time) {
  for (const double step : {1e-4, 1e-3, 1.0 / 60.0}) {
    Ramp ramp;
    double seconds = 0.0;
    for (; ramp != Ramp{1.0, 0.0} && seconds < 2.0; seconds += step) ramp = ramped(ramp, 1.0, step, kLimits);
    EXPECT_EQ(ramp, (Ramp{1.0, 0.0})) << step;
    const double ideal = 1.0 / kLimits.acceleration + kLimits.acceleration / kLimits.jerk;
    EXPECT_GE(seconds, ideal - step);
    EXPECT_LE(seconds, ideal + 0.02 + 4 * step);
  }
}

TEST(Ramp, comes_to_rest_from_any_state_within_the_maximum_stopping_time) {
  for (const double acceleration : {-2.2, -1.0, 0.0, 1.0, 2.2}) {
    for (const double speed : {-1.0, -0.5, 0.0, 0.1, 0.7}) {
      Ramp ramp{speed, acceleration};
      // Skips unreachable states: ramping the acceleration down must stay within the full speed.
      if (std::abs(speed + acceleration * std::abs(acceleration) / (2 * kLimits.jerk)) > 1.0) continue;
      double seconds = 0.0;
      for (; ramp != Ramp{} && seconds < 3.0; seconds += 1e-3) ramp = ramped(ramp, 0.0, 1e-3, kLimits);
      EXPECT_LE(seconds, max_stop_s(1.0, kLimits) + 0.01) << speed << " " << acceleration;
    }
  }
}

TEST(Ramp, keeps_its_limits_and_never_overshoots_for_any_steps) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform;
  Ramp ramp;
  double wanted = 0.0;
  double min = 0.0;  // Lower and upper bound of all speeds wanted so far.
  double max = 0.0;
  for (int i = 0; i < 1'000'000; ++i) {
    if (i % 37 == 0) wanted = 2.0 * uniform(random) - 1.0;
    min = std::min(min, wanted);
    max = std::max(max, wanted);
    const double step = std::pow(10.0, -6.0 + 5.0 * uniform(random));  // From a microsecond to a tenth of a second.
    const Ramp next = ramped(ramp, wanted, step, kLimits);
    ASSERT_LE(std::abs(next.acceleration), kLimits.acceleration + 1e-12);
    ASSERT_LE(std::abs(next.acceleration - ramp.acceleration), kLimits.jerk * step + 0.0061)
        << "0.006: when it settles";
    ASSERT_NEAR(next.speed - ramp.speed, next.acceleration * step, 2e-6);
    ASSERT_GE(next.speed, min - 1e-9);
    ASSERT_LE(next.speed, max + 1e-9);
    ramp = next;
  }
}

TEST(Ramp, does_not_change_without_time) {
  const Ramp ramp{0.5, 1.0};
  EXPECT_EQ(ramped(ramp, 1.0, 0.0, kLimits), ramp);
  EXPECT_EQ(ramped(ramp, 1.0, std::nan(""), kLimits), ramp);
}

}  // namespace
}  // namespace cyclorama::tour
