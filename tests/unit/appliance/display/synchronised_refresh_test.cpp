// SPDX-License-Identifier: Apache-2.0
// Numbers of refreshes in the count of all displays, and what is due at them.
#include "appliance/display/synchronised_refresh.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cyclorama::display {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kPeriod_ns = 10'000'000;
constexpr double kHz = 100.0;
const TimePoint kStart{1000s};

ShowAt at(std::int64_t refresh) { return {refresh, kPeriod_ns, 0}; }

/// An output whose refresh n is at kStart + phase + n periods, on a clock that is the tour's.
class SynchronisedRefreshTest : public ::testing::Test {
 protected:
  void SetUp() override {
    shared_.set_clock({true, 0, 0ns});
    shared_.learn(at(0));
  }
  /// Draws and shows the next refresh, `late` after its time; returns its number.
  std::optional<std::int64_t> refresh(Duration late = 0ns, std::uint64_t missed = 0) {
    shared_.begin(now_);
    count_ += 1 + missed;
    now_ = kStart + phase_ + static_cast<std::int64_t>(count_) * period_;
    shared_.shown({count_, now_ + late}, 1.0 / to_seconds(period_));
    return shared_.number();
  }
  SynchronisedRefresh shared_;
  Duration phase_{};
  Duration period_ = 10ms;
  std::uint64_t count_ = 0;
  TimePoint now_{};
};

TEST_F(SynchronisedRefreshTest, starts_at_the_second_refresh_with_the_nearest_number) {
  for (const auto& [phase, first] :
       {std::pair<Duration, std::int64_t>{0ms, 100002}, {4ms, 100002}, {6ms, 100003}, {9ms, 100003}}) {
    shared_ = {};
    SetUp();
    phase_ = phase;
    count_ = 0;
    EXPECT_EQ(refresh(), std::nullopt) << "nothing is known of the output yet";
    EXPECT_EQ(refresh(), first);
    EXPECT_EQ(refresh(), first + 1);
  }
}

TEST_F(SynchronisedRefreshTest, has_no_number_while_clock_or_period_is_unknown) {
  refresh();
  shared_.set_clock({});
  EXPECT_EQ(refresh(), std::nullopt);
  EXPECT_TRUE(shared_.is_due(at(999'999))) << "better now than never";
  shared_.set_clock({true, 0, 0ns});
  EXPECT_TRUE(refresh());
  shared_.learn({});
  EXPECT_EQ(refresh(), std::nullopt);
}

TEST_F(SynchronisedRefreshTest, counts_missed_refreshes) {
  refresh();
  EXPECT_EQ(refresh(), 100002);
  EXPECT_EQ(refresh(0ns, 3), 100006);
  EXPECT_EQ(refresh(), 100007);
}

TEST_F(SynchronisedRefreshTest, does_not_alternate_between_two_numbers_half_way_between_them) {
  phase_ = 5ms;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> jitter_us(-700, 700);
  refresh();
  const std::int64_t first = *refresh();
  for (std::int64_t n = 1; n < 2000; ++n) {
    shared_.set_clock({true, static_cast<std::uint64_t>(1000 * jitter_us(random)), 0ns});
    ASSERT_EQ(refresh(), first + n);
  }
}

TEST_F(SynchronisedRefreshTest, is_not_shifted_by_occasional_delays) {
  std::mt19937 random(2);
  refresh();
  const std::int64_t first = *refresh();
  for (std::int64_t n = 1; n < 2000; ++n) ASSERT_EQ(refresh(random() % 10 == 0 ? 4900us : 200us), first + n);
}

TEST_F(SynchronisedRefreshTest, skips_a_number_when_a_slower_output_falls_behind) {
  period_ = 10010us;  // 0.1 %: one in a thousand.
  refresh();
  std::int64_t last = *refresh();
  int left_out = 0;
  for (int n = 0; n < 10'000; ++n) {
    const std::int64_t number = *refresh();
    ASSERT_TRUE(number == last + 1 || number == last + 2);
    left_out += number == last + 2 ? 1 : 0;
    last = number;
    // The number is never farther from its own time than the middle plus the hold.
    ASSERT_LE(std::abs(to_milliseconds(now_ - TimePoint(last * 10ms))), 6.1);
  }
  EXPECT_NEAR(left_out, 10, 1);
}

TEST_F(SynchronisedRefreshTest, repeats_a_number_when_a_faster_output_gains_a_refresh) {
  period_ = 9990us;
  refresh();
  std::int64_t last = *refresh();
  int repeated = 0;
  for (int n = 0; n < 10'000; ++n) {
    const std::int64_t number = *refresh();
    ASSERT_TRUE(number == last + 1 || number == last);
    repeated += number == last ? 1 : 0;
    last = number;
  }
  EXPECT_NEAR(repeated, 10, 1);
}

TEST_F(SynchronisedRefreshTest, follows_a_changed_rate_and_a_stepped_clock) {
  refresh();
  refresh();
  shared_.set_clock({true, static_cast<std::uint64_t>(std::int64_t{3'600'000'000'000}), 0ns});
  EXPECT_EQ(refresh(), 100003 + 360'000);
  period_ = 20ms;
  refresh();
  const std::int64_t number = *refresh();
  EXPECT_EQ(*refresh(), number + 2) << "every second number";
}

TEST_F(SynchronisedRefreshTest, selects_what_is_due) {
  refresh();
  refresh();
  shared_.begin(now_);  // Refresh 100003.
  EXPECT_TRUE(shared_.is_due({})) << "nothing was said";
  EXPECT_TRUE(shared_.is_due(at(-7)));
  EXPECT_TRUE(shared_.is_due(at(100003)));
  EXPECT_FALSE(shared_.is_due(at(100004)));
  EXPECT_FALSE(shared_.is_due(at(100103)));
  EXPECT_TRUE(shared_.is_due(at(100104))) << "more than a second ahead: of another clock";
  EXPECT_TRUE(shared_.is_due({100004, kPeriod_ns + 1, 0})) << "counted otherwise";
}

TEST_F(SynchronisedRefreshTest, reports_how_long_before_its_refresh_drawing_begins) {
  phase_ = -3ms;
  refresh();
  refresh();
  shared_.begin(kStart - 3ms + 2 * 10ms + 2ms);  // For the refresh at kStart + 27 ms, whose number is at 30 ms.
  EXPECT_NEAR(to_milliseconds(shared_.drawn_ahead()), 11.0, 0.01);
}

TEST_F(SynchronisedRefreshTest, survives_arbitrary_clocks) {
  for (const std::int64_t theirs :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(), std::int64_t{-1}}) {
    shared_.set_clock({true, static_cast<std::uint64_t>(theirs), 0ns});
    for (const std::int64_t period_ns : {1'000'000LL, 10'000'000'000LL}) {
      shared_.learn({0, period_ns, 0});
      for (int n = 0; n < 3; ++n) refresh();
      static_cast<void>(shared_.is_due({kMaxShowAt_ns / period_ns, period_ns, 0}));
      static_cast<void>(shared_.is_due({-kMaxShowAt_ns / period_ns, period_ns, 0}));
    }
  }
}

}  // namespace
}  // namespace cyclorama::display
