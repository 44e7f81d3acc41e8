// SPDX-License-Identifier: Apache-2.0
// The exchange of times by which a display estimates the tour's clock, and the needs that it reports with it.
#include "appliance/display/tour_clock.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::display {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kPeriod_ns = 16'666'667;

class TourClockTest : public ::testing::Test {
 protected:
  /// The tour's clock is 7 s ahead of ours; each way takes a millisecond.
  wire::ClockReply answer(const wire::ClockRequest& question) const {
    wire::ClockReply answer;
    answer.set_asked_ns(question.asked_ns());
    answer.set_received_ns(to_nanoseconds(now_ + 7s + 1ms));
    answer.set_answered_ns(to_nanoseconds(now_ + 7s + 1ms));
    answer.set_system_ns((system_now_ - 40ms + 1ms).time_since_epoch().count());
    return answer;
  }
  bool ask() {
    const auto question = clock_.question(now_);
    if (!question) return false;
    last_ = *question;
    const wire::ClockReply reply = answer(*question);
    pass(2ms);
    return clock_.take(reply, now_);
  }
  void pass(Duration time) {
    now_ += time;
    system_now_ += time;
  }
  TimePoint now_{5000s};
  SystemTime system_now_{1'700'000'000s};
  TourClock clock_{[this] { return system_now_; }};
  wire::ClockRequest last_;
};

TEST_F(TourClockTest, learns_the_tours_clock_and_the_offset_of_the_system_clocks) {
  EXPECT_FALSE(clock_.reading(now_).is_known);
  EXPECT_FALSE(clock_.skew());
  ASSERT_TRUE(ask());
  EXPECT_EQ(clock_.reading(now_).at(now_), to_nanoseconds(now_ + 7s));
  ASSERT_TRUE(clock_.skew());
  EXPECT_EQ(clock_.skew()->ahead, 40ms);
  EXPECT_NEAR(to_milliseconds(clock_.skew()->error), 1.0, 0.001);
  pass(1s);
  ASSERT_TRUE(ask());
  EXPECT_NEAR(last_.skew_s(), 0.040, 1e-9);
  EXPECT_NEAR(last_.skew_error_s(), 0.001, 1e-6);
}

TEST_F(TourClockTest, asks_often_at_first_and_then_a_few_times_a_second) {
  int questions = 0;
  for (const TimePoint end = now_ + 10s; now_ < end; pass(5ms)) questions += ask() ? 1 : 0;
  EXPECT_NEAR(questions, 16 + 38, 3);
}

TEST_F(TourClockTest, asks_again_after_a_second_and_ignores_a_late_answer) {
  const auto lost = clock_.question(now_);
  ASSERT_TRUE(lost);
  pass(990ms);
  EXPECT_FALSE(clock_.question(now_));
  pass(20ms);
  const auto second = clock_.question(now_);
  ASSERT_TRUE(second);
  EXPECT_FALSE(clock_.take(answer(*lost), now_));
  EXPECT_TRUE(clock_.take(answer(*second), now_ + 2ms));
  EXPECT_FALSE(clock_.take(answer(*second), now_ + 2ms)) << "once";
}

TEST_F(TourClockTest, ignores_answers_to_questions_that_it_never_asked) {
  EXPECT_FALSE(clock_.take({}, now_));
  const auto question = clock_.question(now_);
  wire::ClockReply foreign = answer(*question);
  foreign.set_asked_ns(foreign.asked_ns() + 1);
  EXPECT_FALSE(clock_.take(foreign, now_));
  wire::ClockReply nonsense = answer(*question);
  nonsense.set_answered_ns(std::numeric_limits<std::int64_t>::min());
  EXPECT_FALSE(clock_.take(nonsense, now_));
  EXPECT_FALSE(clock_.reading(now_).is_known);
}

TEST_F(TourClockTest, survives_answers_with_arbitrary_times) {
  for (const std::int64_t time : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    pass(2s);
    const auto question = clock_.question(now_);
    ASSERT_TRUE(question);
    wire::ClockReply odd = answer(*question);
    odd.set_received_ns(time);
    odd.set_answered_ns(time);
    odd.set_system_ns(-time);
    EXPECT_TRUE(clock_.take(odd, now_));
    clock_.frame_ready({0, kPeriod_ns, time}, now_);
    clock_.frame_ready({0, kPeriod_ns, -time}, now_);
    clock_.reset();
  }
}

TEST_F(TourClockTest, reports_the_longest_need_since_the_last_question) {
  ASSERT_TRUE(ask());
  const auto told = [&](Duration ago) { return ShowAt{1, kPeriod_ns, to_nanoseconds(now_ + 7s - ago)}; };
  clock_.frame_ready(told(20ms), now_);
  clock_.frame_ready(told(31ms), now_);
  clock_.heading_ready(told(2ms), now_);
  clock_.frame_ready({}, now_);  // It was shown at once, so nothing was needed.
  clock_.frame_ready(told(-2s), now_);
  clock_.frame_ready(told(100h), now_);
  clock_.drawn_ahead(5ms);
  clock_.drawn_ahead(8ms);
  clock_.drawn_ahead(-1ms);
  pass(1s);
  ASSERT_TRUE(ask());
  EXPECT_NEAR(last_.frame_need_s(), 0.039, 1e-6);
  EXPECT_NEAR(last_.heading_need_s(), 0.010, 1e-6);
  pass(1s);
  ASSERT_TRUE(ask());
  EXPECT_EQ(last_.frame_need_s(), 0.0);
  EXPECT_EQ(last_.heading_need_s(), 0.0);
}

TEST_F(TourClockTest, forgets_a_lost_tour) {
  ASSERT_TRUE(ask());
  clock_.reset();
  EXPECT_FALSE(clock_.reading(now_).is_known);
  EXPECT_FALSE(clock_.skew());
  EXPECT_TRUE(ask()) << "at once";
}

TEST(ShowAt, is_empty_for_an_invalid_time) {
  wire::ShowMessage message;
  const auto parsed = [&](std::int64_t refresh, std::int64_t period_ns) {
    message.mutable_show_at()->set_refresh(refresh);
    message.mutable_show_at()->set_period_ns(period_ns);
    message.mutable_show_at()->set_told_ns(9);
    return show_at_of(message);
  };
  EXPECT_EQ(show_at_of({}).period_ns, 0);
  for (const std::int64_t period_ns :
       {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0}, std::int64_t{999'999},
        std::int64_t{10'000'000'001}, std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(parsed(5, period_ns).period_ns, 0) << period_ns;
  }
  for (const std::int64_t refresh :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(parsed(refresh, kPeriod_ns).period_ns, 0);
  }
  const ShowAt fine = parsed(-3, kPeriod_ns);
  EXPECT_EQ(fine.refresh, -3);
  EXPECT_EQ(fine.period_ns, kPeriod_ns);
  EXPECT_EQ(fine.told_ns, 9);
  EXPECT_EQ(parsed(kMaxShowAt_ns / 1'000'000, 1'000'000).period_ns, 1'000'000);
  EXPECT_EQ(parsed(kMaxShowAt_ns / 1'000'000 + 1, 1'000'000).period_ns, 0);
}

}  // namespace
}  // namespace cyclorama::display
