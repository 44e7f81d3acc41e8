// SPDX-License-Identifier: Apache-2.0
#include "common/opening/wall_clock.h"

#include <gtest/gtest.h>

#include <fstream>

namespace cyclorama {
namespace {

TEST(WallClock, is_trusted_unless_it_was_lost_and_not_synchronised_since) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "wall_clock_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const ClockMarks marks{folder / "lost", folder / "synchronized"};
  const WallTime now = WallTime(std::chrono::hours(24 * 365 * 57));
  EXPECT_EQ(wall_time(now, marks), now);
  std::ofstream(marks.lost).flush();
  EXPECT_EQ(wall_time(now, marks), WallTime{});
  const auto never = OpeningHours::parse({"2027-01-01 closed"}, "UTC");
  ASSERT_TRUE(never);
  EXPECT_FALSE(never->is_open(now));
  EXPECT_TRUE(never->is_open(wall_time(now, marks)));
  std::ofstream(marks.synchronized).flush();
  EXPECT_EQ(wall_time(now, marks), now);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace cyclorama
