// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/power/projector_duty.h"

#include <gtest/gtest.h>

namespace cyclorama::output {
namespace {

using enum ProjectorPower;
constexpr std::optional<bool> kNothing;

TEST(ProjectorDuty, switches_a_projector_until_it_is_in_the_required_state) {
  ProjectorDuty duty;
  EXPECT_EQ(duty.next(true, kOff), true);
  EXPECT_EQ(duty.next(true, kOff), true);  // The command was lost.
  EXPECT_EQ(duty.next(true, kWarming), kNothing);
  EXPECT_EQ(duty.next(true, kOn), kNothing);
  EXPECT_EQ(duty.next(false, kOn), false);
  EXPECT_EQ(duty.next(false, kCooling), kNothing);
  EXPECT_EQ(duty.next(false, kOff), kNothing);
}

TEST(ProjectorDuty, works_after_a_restart_at_any_moment) {
  EXPECT_EQ(ProjectorDuty().next(true, kOff), true);
  EXPECT_EQ(ProjectorDuty().next(false, kOn), false);
  EXPECT_EQ(ProjectorDuty().next(true, kOn), kNothing);
  EXPECT_EQ(ProjectorDuty().next(false, kOff), kNothing);
}

TEST(ProjectorDuty, waits_for_one_that_is_changing_to_the_opposite_state) {
  ProjectorDuty duty;
  EXPECT_EQ(duty.next(true, kCooling), kNothing);
  EXPECT_EQ(duty.next(true, kOff), true);
  EXPECT_EQ(duty.next(false, kWarming), kNothing);
  EXPECT_EQ(duty.next(false, kOn), false);
}

TEST(ProjectorDuty, respects_manual_switching_until_the_hours_change) {
  ProjectorDuty duty;
  duty.next(true, kOn);
  for (int n = 0; n < 5; ++n) EXPECT_EQ(duty.next(true, kOff), kNothing);
  EXPECT_EQ(duty.next(true, kCooling), kNothing);
  EXPECT_EQ(duty.next(false, kOff), kNothing);
  for (int n = 0; n < 5; ++n) EXPECT_EQ(duty.next(false, kOn), kNothing);
  EXPECT_EQ(duty.next(true, kOn), kNothing);
  EXPECT_EQ(duty.next(false, kOn), false);
}

TEST(ProjectorDuty, switches_one_that_was_without_power) {
  ProjectorDuty duty;
  duty.next(true, kOn);
  EXPECT_EQ(duty.next(true, std::nullopt), kNothing);
  EXPECT_EQ(duty.next(true, kOff), true);
  duty.next(false, kOff);
  duty.next(false, std::nullopt);
  EXPECT_EQ(duty.next(false, kOn), false);
}

}  // namespace
}  // namespace cyclorama::output
