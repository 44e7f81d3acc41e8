// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/pace.h"

#include <gtest/gtest.h>

#include "tests/doubles/fake_clock.h"

namespace cyclorama::camera {
namespace {

using std::chrono::milliseconds;

const TimePoint kStart(std::chrono::seconds(1000));
const Pace kPace{kStart, milliseconds(100)};

TEST(Pace, delivers_the_first_picture_at_once_and_none_twice) {
  EXPECT_EQ(kPace.next(kStart, std::nullopt), 0U);
  EXPECT_EQ(kPace.next(kStart, 0), 1U);
  EXPECT_EQ(kPace.next(kStart + milliseconds(99), 0), 1U);
}

TEST(Pace, gives_a_late_caller_the_newest_picture) { EXPECT_EQ(kPace.next(kStart + milliseconds(1050), 2), 10U); }

TEST(Pace, waits_for_the_first_picture_if_the_clock_is_before_the_start) {
  EXPECT_EQ(kPace.next(kStart - milliseconds(500), std::nullopt), 0U);
  EXPECT_EQ(kPace.next(kStart - milliseconds(500), 3), 4U);
}

TEST(WaitForPicture, waits_no_longer_than_the_deadline) {
  const FakeClock clock(kStart + milliseconds(10));
  const auto late = wait_for_picture(kPace, 0, clock, kStart + milliseconds(50));
  ASSERT_FALSE(late.has_value());
  EXPECT_EQ(late.error().code(), ErrorCode::kTimedOut);
  EXPECT_EQ(clock.now(), kStart + milliseconds(50));
  const auto ready = wait_for_picture(kPace, 0, clock, kStart + milliseconds(500));
  ASSERT_TRUE(ready.has_value());
  EXPECT_EQ(*ready, 1U);
  EXPECT_EQ(clock.now(), kStart + milliseconds(100));
}

TEST(WaitForPicture, returns_a_ready_picture_even_after_the_deadline) {
  const FakeClock clock(kStart + milliseconds(450));
  const auto ready = wait_for_picture(kPace, 0, clock, kStart);
  ASSERT_TRUE(ready.has_value());
  EXPECT_EQ(*ready, 4U);
}

}  // namespace
}  // namespace cyclorama::camera
