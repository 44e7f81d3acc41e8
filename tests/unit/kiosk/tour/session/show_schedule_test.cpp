// SPDX-License-Identifier: Apache-2.0
// Tests of the schedule of several displays, and of the tour's roster of them.
#include "kiosk/tour/session/show_schedule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "kiosk/tour/session/display_roster.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;

const TimePoint kNow{1000s};

wire::DisplayHello hello(double refresh_hz, const std::string& name = "hall") {
  wire::DisplayHello hello;
  hello.set_name(name);
  hello.set_heads(3);
  hello.set_refresh_hz(refresh_hz);
  return hello;
}
wire::ClockRequest needing(double frame_s, double heading_s = 0.0) {
  wire::ClockRequest question;
  question.set_frame_need_s(frame_s);
  question.set_heading_need_s(heading_s);
  return question;
}
/// Returns the time from now to the synchronised refresh.
Duration ahead(const wire::ShowAt& at, TimePoint now) {
  return TimePoint(std::chrono::nanoseconds(at.refresh() * at.period_ns())) - now;
}

class ShowScheduleTest : public ::testing::Test {
 protected:
  void SetUp() override {
    schedule_.joined(1, hello(100.0));
    schedule_.joined(2, hello(100.0));
  }
  ShowSchedule schedule_;
};

TEST_F(ShowScheduleTest, sends_no_presentation_time_to_a_single_display) {
  schedule_.left(1);
  EXPECT_FALSE(schedule_.frame_at(kNow));
  EXPECT_FALSE(schedule_.heading_at(kNow));
  EXPECT_EQ(schedule_.frame_lead(kNow), 0ms);
  schedule_.joined(3, hello(100.0));
  EXPECT_TRUE(schedule_.frame_at(kNow));
  EXPECT_TRUE(schedule_.heading_at(kNow));
  schedule_.left(2);
  schedule_.left(3);
  EXPECT_FALSE(schedule_.frame_at(kNow)) << "nobody is here";
}

TEST_F(ShowScheduleTest, chooses_the_next_refresh_that_the_slowest_display_can_meet) {
  schedule_.measured(needing(0.023, 0.004), kNow);
  schedule_.measured(needing(0.011, 0.001), kNow);
  const auto frame = schedule_.frame_at(kNow + 1ms);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->period_ns(), 10'000'000);
  EXPECT_EQ(frame->told_ns(), to_nanoseconds(kNow + 1ms));
  EXPECT_EQ(ahead(*frame, kNow), 30ms);
  EXPECT_EQ(ahead(*schedule_.heading_at(kNow + 1ms), kNow), 10ms);
  EXPECT_EQ(ahead(*schedule_.heading_at(kNow + 5ms), kNow), 20ms);
}

TEST_F(ShowScheduleTest, remembers_the_longest_need_for_a_minute) {
  schedule_.measured(needing(0.080), kNow);
  for (int s = 0; s < 59; ++s) schedule_.measured(needing(0.010), kNow + s * 1s);
  EXPECT_EQ(schedule_.frame_lead(kNow + 59s), 82ms);
  EXPECT_EQ(schedule_.frame_lead(kNow + 60s), 12ms);
}

TEST_F(ShowScheduleTest, waits_neither_for_a_display_that_is_too_slow_nor_for_an_invalid_need) {
  schedule_.measured(needing(0.010, 0.010), kNow);
  for (const double need : {0.251, 1e300, -5.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
    schedule_.measured(needing(need, need), kNow);
    EXPECT_EQ(schedule_.frame_lead(kNow), 12ms) << need;
    EXPECT_EQ(schedule_.heading_lead(kNow), 12ms) << need;
  }
  schedule_.measured(needing(0.249), kNow);
  EXPECT_EQ(schedule_.frame_lead(kNow), 251ms);
}

TEST_F(ShowScheduleTest, gives_each_frame_its_own_refresh_unless_frames_come_faster) {
  schedule_.measured(needing(0.010), kNow);
  const std::int64_t first = schedule_.frame_at(kNow)->refresh();
  EXPECT_EQ(schedule_.frame_at(kNow + 1ms)->refresh(), first + 1) << "in the same period";
  EXPECT_EQ(schedule_.frame_at(kNow + 11ms)->refresh(), first + 2);
  // Faster than the displays can show: no queue grows.
  std::int64_t last = 0;
  for (int n = 0; n < 1000; ++n) last = schedule_.frame_at(kNow + 12ms + n * 1ms)->refresh();
  EXPECT_LE(last, schedule_.heading_at(kNow + 1012ms)->refresh() + 1);
}

TEST_F(ShowScheduleTest, never_goes_back_when_displays_become_faster) {
  schedule_.measured(needing(0.100, 0.100), kNow);
  const std::int64_t frame = schedule_.frame_at(kNow + 59s)->refresh();
  const std::int64_t heading = schedule_.heading_at(kNow + 59s)->refresh();
  schedule_.measured(needing(0.001, 0.001), kNow + 60s);
  EXPECT_GE(schedule_.frame_at(kNow + 60s)->refresh(), frame);
  EXPECT_GE(schedule_.heading_at(kNow + 60s)->refresh(), heading);
}

TEST_F(ShowScheduleTest, counts_refreshes_at_the_rate_of_the_slowest_display) {
  schedule_.joined(3, hello(50.0));
  EXPECT_EQ(schedule_.frame_at(kNow)->period_ns(), 20'000'000);
  schedule_.joined(4, hello(-1.0));
  schedule_.joined(5, hello(std::nan("")));
  schedule_.joined(6, hello(1e-9));
  EXPECT_EQ(schedule_.frame_at(kNow)->period_ns(), 20'000'000);
  schedule_.left(3);
  EXPECT_EQ(schedule_.frame_at(kNow)->period_ns(), 10'000'000);
}

TEST(DisplayRoster, names_the_least_synchronised_display) {
  DisplayRoster roster;
  roster.joined(1, hello(60.0, "left\n"));
  roster.joined(2, hello(60.0, "right"));
  EXPECT_FALSE(roster.synchronised_share());
  wire::ClockRequest question;
  question.set_synchronised_share(0.999);
  question.set_skew_s(-0.0123);
  question.set_skew_error_s(0.0002);
  question.set_frame_need_s(0.02);
  roster.heard(1, question);
  EXPECT_FALSE(roster.synchronised_share()) << "one display alone is synchronised with nothing";
  question.clear_frame_need_s();
  roster.heard(1, question);
  question.set_synchronised_share(0.5);
  roster.heard(2, question);
  EXPECT_EQ(roster.synchronised_share(), 0.5);
  question.set_synchronised_share(std::nan(""));
  roster.heard(2, question);
  EXPECT_FALSE(roster.synchronised_share());
  roster.heard(9, question);  // This display has left, or never joined.

  const wire::Table table = roster.table();
  EXPECT_EQ(table.name(), "displays");
  ASSERT_EQ(table.rows_size(), 2);
  for (const wire::Row& row : table.rows()) ASSERT_EQ(row.cells_size(), table.columns_size());
  EXPECT_EQ(table.rows(0).cells(0).text().find('\n'), std::string::npos);
  EXPECT_NEAR(table.rows(0).cells(3).number(), 99.9, 1e-9);
  EXPECT_NEAR(table.rows(0).cells(4).number(), -12.3, 1e-9);
  EXPECT_NEAR(table.rows(0).cells(6).number(), 20.0, 1e-9) << "the newest that was measured";
  EXPECT_EQ(table.rows(1).cells(3).value_case(), wire::Cell::VALUE_NOT_SET);
  roster.left(1);
  EXPECT_EQ(roster.table().rows_size(), 1);
}

}  // namespace
}  // namespace cyclorama::tour
