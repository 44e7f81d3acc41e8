// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/headless/refresh_schedule.h"

#include <gtest/gtest.h>

namespace cyclorama::output {
namespace {

const TimePoint kStart = from_nanoseconds(1'000'000'000'000);

TEST(RefreshSchedule, keeps_its_pace_however_long_the_work_takes) {
  RefreshSchedule schedule(30.0, kStart);
  TimePoint now = kStart;
  for (std::uint64_t n = 0; n < 100'000; ++n) {
    const auto refresh = schedule.next(now);
    ASSERT_EQ(refresh.number, n);
    ASSERT_NEAR(to_seconds(refresh.at - kStart), static_cast<double>(n) / 30.0, 1e-6);  // No drift after an hour.
    now = refresh.at + std::chrono::milliseconds(n % 33);
  }
  EXPECT_EQ(schedule.missed(), 0U);
}

TEST(RefreshSchedule, skips_and_counts_refreshes_that_have_passed) {
  RefreshSchedule schedule(10.0, kStart);
  EXPECT_EQ(schedule.next(kStart).number, 0U);
  const auto late = schedule.next(kStart + std::chrono::milliseconds(450));
  EXPECT_EQ(late.number, 5U);
  EXPECT_EQ(late.at, kStart + std::chrono::milliseconds(500));
  EXPECT_EQ(schedule.missed(), 4U);
  EXPECT_EQ(schedule.next(kStart + std::chrono::milliseconds(501)).number, 6U);
}

TEST(RefreshSchedule, numbers_a_slightly_late_refresh_correctly) {
  RefreshSchedule schedule(10.0, kStart);
  EXPECT_EQ(schedule.next(kStart).number, 0U);
  const auto refresh = schedule.next(kStart + std::chrono::milliseconds(130));
  EXPECT_EQ(refresh.number, 1U);
  EXPECT_EQ(refresh.at, kStart + std::chrono::milliseconds(100));  // In the past, so no wait.
  EXPECT_EQ(schedule.missed(), 0U);
}

}  // namespace
}  // namespace cyclorama::output
