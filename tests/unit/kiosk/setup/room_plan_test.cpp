// SPDX-License-Identifier: Apache-2.0
#include "kiosk/setup/room_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/room/installation.h"

namespace cyclorama::setup {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

RoomPlan three_in_a_round_room() {
  RoomPlan plan;
  plan.projectors = {{"left", "HDMI-A-1", "192.0.2.11"}, {"middle", "HDMI-A-2"}, {"right", "DP-1"}};
  return plan;
}

TEST(RoomPlan, becomes_an_installation_that_can_be_read) {
  const auto room = parse_installation(installation_toml(three_in_a_round_room()), "installation.toml");
  ASSERT_TRUE(room) << room.error().message();
  ASSERT_EQ(room->projectors.size(), 3U);
  EXPECT_EQ(room->projectors[0].plug.connector, "HDMI-A-1");
  EXPECT_EQ(room->projectors[0].pjlink->address.host, "192.0.2.11");
  EXPECT_TRUE(check_connectors(*room));
}

TEST(RoomPlan, lights_the_whole_wall_from_left_to_right) {
  const auto reach = reach_of(three_in_a_round_room());
  ASSERT_TRUE(reach) << reach.error().message();
  EXPECT_NEAR(reach->length_m, 6.6, 0.01);
  EXPECT_GT(reach->lit_fraction, 0.99);
  EXPECT_GT(reach->shared_fraction, 0.1);
  EXPECT_THAT(reach->hints, IsEmpty());
  ASSERT_EQ(reach->pictures.size(), 3U);
  const auto middle_of = [&](std::size_t i) {
    double sum = 0.0;
    for (const WallPoint& point : reach->pictures[i]) sum += point.along_m;
    return sum / static_cast<double>(reach->pictures[i].size());
  };
  for (const std::size_t i : {0U, 1U, 2U}) EXPECT_NEAR(middle_of(i), 6.6 * (static_cast<double>(i) + 0.5) / 3.0, 0.05);
}

TEST(RoomPlan, is_as_wide_on_a_flat_wall_as_was_measured) {
  RoomPlan plan = three_in_a_round_room();
  plan.is_round = false;
  plan.projectors.resize(1);
  plan.width_m = 4.0;
  plan.picture_width_m = 2.0;
  const auto reach = reach_of(plan);
  ASSERT_TRUE(reach) << reach.error().message();
  double left = 1e9;
  double right = 0.0;
  for (const WallPoint& point : reach->pictures[0]) {
    left = std::min(left, point.along_m);
    right = std::max(right, point.along_m);
  }
  EXPECT_NEAR(left, 1.0, 1e-3);
  EXPECT_NEAR(right, 3.0, 1e-3);
}

TEST(RoomPlan, says_what_stays_dark) {
  RoomPlan plan = three_in_a_round_room();
  plan.picture_width_m = 1.5;
  const auto gaps = reach_of(plan);
  ASSERT_TRUE(gaps);
  EXPECT_LT(gaps->lit_fraction, 0.9);
  EXPECT_FALSE(gaps->hints.empty());
  plan = three_in_a_round_room();
  plan.top_m = 4.5;
  EXPECT_THAT(reach_of(plan)->hints, Contains(HasSubstr("The top of the wall stays dark")));
  plan = three_in_a_round_room();
  plan.projectors.resize(1);
  EXPECT_THAT(reach_of(plan)->hints, Contains(HasSubstr("The sides of the wall stay dark")));
}

TEST(RoomPlan, refuses_a_projector_behind_the_wall) {
  RoomPlan plan = three_in_a_round_room();
  plan.lens_distance_m = 7.0;
  const auto reach = reach_of(plan);
  ASSERT_FALSE(reach);
  EXPECT_THAT(reach.error().message(), HasSubstr("position_m"));
}

}  // namespace
}  // namespace cyclorama::setup
