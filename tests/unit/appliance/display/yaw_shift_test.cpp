// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/yaw_shift.h"

#include <gtest/gtest.h>

#include <numbers>

#include "appliance/display/shown_parts.h"

namespace cyclorama::display {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(YawShift, is_the_turn_since_the_picture_was_requested) {
  EXPECT_NEAR(yaw_shift(0.3, 0.38, 0.1).angle_rad, 0.08, 1e-12);
  EXPECT_NEAR(yaw_shift(0.3, 0.25, 0.1).angle_rad, -0.05, 1e-12);
  EXPECT_FALSE(yaw_shift(0.3, 0.25, 0.1).is_past_guard);
}

TEST(YawShift, takes_the_short_way_round) {
  EXPECT_NEAR(yaw_shift(kPi - 0.02, -kPi + 0.03, 0.1).angle_rad, 0.05, 1e-12);
  EXPECT_NEAR(yaw_shift(0.01 + 20.0 * kPi, 0.03, 0.1).angle_rad, 0.02, 1e-9);
}

TEST(YawShift, stops_at_the_end_of_the_picture_and_reports_it) {
  const YawShift right = yaw_shift(0.0, 0.5, 0.1);
  EXPECT_NEAR(right.angle_rad, 0.1, 1e-12);
  EXPECT_TRUE(right.is_past_guard);
  EXPECT_NEAR(yaw_shift(0.0, -3.0, 0.1).angle_rad, -0.1, 1e-12);
  EXPECT_EQ(yaw_shift(0.0, 0.5, 0.0).angle_rad, 0.0);
}

TEST(YawShift, is_limited_by_the_guard_band) {
  const Panorama picture{2200, 400, 2.2, 0.4, -0.4};
  const auto reach_of = [&](double shown_span_rad) {
    return shown_parts({}, picture, Panorama{2000, 400, shown_span_rad, 0.4, -0.4}).turn_limit_rad;
  };
  EXPECT_NEAR(reach_of(2.0), 0.1, 1e-12);
  // A picture without any guard band, and one that is narrower than the wall, do not move.
  EXPECT_EQ(reach_of(2.2), 0.0);
  EXPECT_EQ(reach_of(3.0), 0.0);
}

TEST(YawShift, recognises_a_full_circle) {
  EXPECT_TRUE(is_whole_turn({6283, 400, 2.0 * kPi, 0.4, -0.4}));
  const Panorama guarded = Panorama{1000, 100, 2.2, 0.2, -0.2}.with_guard_band(10.0);
  EXPECT_TRUE(is_whole_turn(guarded));
  EXPECT_FALSE(is_whole_turn({1000, 100, 6.2, 0.2, -0.2}));
}

}  // namespace
}  // namespace cyclorama::display
