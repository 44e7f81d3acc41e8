// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/refresh_pace.h"

#include <gtest/gtest.h>

namespace cyclorama::output {
namespace {

using std::chrono::milliseconds;

const TimePoint kStart(std::chrono::seconds(100));

TEST(RefreshPace, counts_by_time_so_that_missed_refreshes_show) {
  RefreshPace pace(100.0, kStart);
  pace.shown(kStart + milliseconds(10), true);
  EXPECT_EQ(pace.number(), 1U);
  pace.shown(kStart + milliseconds(41), true);
  EXPECT_EQ(pace.number(), 4U);
  pace.shown(kStart + milliseconds(41), true);  // The clock stands still.
  EXPECT_EQ(pace.number(), 5U);
  EXPECT_GT(pace.shown_at(), kStart + milliseconds(41));
}

TEST(RefreshPace, starts_drawing_as_late_as_the_slowest_picture_allows) {
  RefreshPace pace(50.0, kStart);
  pace.drawn(milliseconds(4));
  pace.drawn(milliseconds(1));
  pace.shown(kStart + milliseconds(20), true);
  EXPECT_EQ(pace.next_at(), kStart + milliseconds(40));
  EXPECT_EQ(pace.begin_at(), kStart + milliseconds(40) - milliseconds(4) - std::chrono::microseconds(2500));
  for (int n = 0; n < 64; ++n) pace.drawn(milliseconds(1));
  EXPECT_EQ(pace.begin_at(), kStart + milliseconds(40) - milliseconds(1) - std::chrono::microseconds(2500));
}

TEST(RefreshPace, starts_earlier_after_a_miss_and_returns_gradually) {
  RefreshPace pace(50.0, kStart);
  TimePoint at = kStart;
  pace.shown(at += milliseconds(20), true);
  const auto before = pace.next_at() - pace.begin_at();
  pace.shown(at += milliseconds(40), true);
  EXPECT_EQ(pace.next_at() - pace.begin_at(), 2 * before);
  for (int n = 0; n < 10; ++n) pace.shown(at += milliseconds(40), true);
  EXPECT_EQ(pace.next_at() - pace.begin_at(), Duration(milliseconds(20)));  // Never earlier than the last refresh.
  for (int n = 0; n < 2000; ++n) pace.shown(at += milliseconds(20), true);
  EXPECT_EQ(pace.next_at() - pace.begin_at(), before);
}

TEST(RefreshPace, waits_for_the_refresh_if_flips_do_not) {
  RefreshPace pace(50.0, kStart);
  pace.shown(kStart + milliseconds(20), false);
  EXPECT_EQ(pace.begin_at(), kStart + milliseconds(40));
}

}  // namespace
}  // namespace cyclorama::output
