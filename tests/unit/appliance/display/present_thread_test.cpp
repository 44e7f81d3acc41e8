// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/present_thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "tests/doubles/fake_clock.h"
#include "tests/doubles/fake_outputs.h"
#include "tests/support/plain_show.h"

namespace cyclorama::display {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;

constexpr int kWidth = 64;
constexpr int kHeight = 48;

class PresentThreadTest : public ::testing::Test {
 protected:
  PresentPlan plan() {
    PresentPlan plan;
    plan.open_output = [this] { return outputs_.open({{{"a", kWidth, kHeight}}, 200.0, {}, {}}, clock_); };
    plan.heads = {plain_head(kWidth, kHeight)};
    plan.attract = *frame_of(0, plain(32, 16, 0));
    plan.times = {std::chrono::seconds(3600), std::chrono::milliseconds(1)};
    return plan;
  }
  void start(const Clock& clock) {
    auto present = PresentThread::start(plan(), &mailbox_, &clock);
    ASSERT_TRUE(present) << present.error().message();
    present_ = *std::move(present);
  }
  /// Serves as the display's main does; returns false if it takes too long.
  bool serve_until(const std::function<bool()>& condition) {
    const TimePoint deadline = clock_.now() + std::chrono::seconds(20);
    while (!condition()) {
      if (clock_.now() > deadline) return false;
      mailbox_.retired.clear([](const DisplayFrame&) {});
      while (mailbox_.refreshes.pop()) ++refreshes_;
      if (auto state = present_->take_state()) state_ = *state;
      EXPECT_TRUE(present_->is_alive());
      std::this_thread::yield();
    }
    return true;
  }
  /// Returns the picture of the next refresh.
  RgbImage shown() {
    std::unique_ptr<RgbImage> picture;
    mailbox_.heads[0].want([] { return std::make_unique<RgbImage>(kWidth, kHeight); });
    EXPECT_TRUE(serve_until([&] { return (picture = mailbox_.heads[0].take()) != nullptr; }));
    return picture == nullptr ? RgbImage(1, 1) : *picture;
  }

  SteadyClock clock_;
  FakeOutputs outputs_;
  PresentMailbox mailbox_{1};
  std::unique_ptr<PresentThread> present_;
  OutputState state_;
  int refreshes_ = 0;
};

TEST_F(PresentThreadTest, reopens_a_lost_output_and_shows_the_newest_frame) {
  start(clock_);
  EXPECT_TRUE(serve_until([&] { return !state_.kind.empty(); }));
  EXPECT_GT(present_->max_side_px(), 1000);
  mailbox_.frames.put(frame_of(1, plain(40, 20, 180)));
  EXPECT_TRUE(serve_until([&] { return refreshes_ > 10; }));
  EXPECT_THAT(shown().data(), Each(AllOf(Ge(179), Le(181))));

  outputs_.lose();
  EXPECT_TRUE(serve_until([&] { return state_.loss.has_value() && outputs_.attempts() >= 4; }));
  EXPECT_THAT(state_.loss->message(), HasSubstr("pulled out"));
  EXPECT_TRUE(serve_until([&] { return !mailbox_.refreshes.pop(); }));
  const int before = refreshes_;

  outputs_.find();
  EXPECT_TRUE(serve_until([&] { return !state_.loss && refreshes_ > before; }));
  EXPECT_THAT(shown().data(), Each(AllOf(Ge(179), Le(181))));
  EXPECT_EQ(state_.losses, 1);
}

TEST_F(PresentThreadTest, cannot_start_without_an_output) {
  outputs_.lose();
  const auto present = PresentThread::start(plan(), &mailbox_, &clock_);
  ASSERT_FALSE(present);
  EXPECT_EQ(present.error().code(), ErrorCode::kUnavailable);
}

TEST_F(PresentThreadTest, reports_progress_of_a_start_but_not_of_one_that_hangs) {
  PresentPlan slow = plan();
  std::atomic<bool> goes_on = true;
  std::atomic<int> told = 0;
  int told_until_it_went_on = 0;
  slow.open_output = [&, open = slow.open_output] {
    for (int step = 0; told < 2; ++step) {
      if (goes_on) mailbox_.stepped_at = TimePoint{} + std::chrono::seconds(step + 1);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    // Longer than the interval between two reports.
    std::this_thread::sleep_for(std::chrono::milliseconds(2200));
    told_until_it_went_on = told;
    return open();
  };
  const auto present = PresentThread::start(std::move(slow), &mailbox_, &clock_, [&] { goes_on = ++told < 2; });
  ASSERT_TRUE(present) << present.error().message();
  EXPECT_THAT(told_until_it_went_on, AllOf(Ge(2), Le(3)));  // The last step may be reported after the second report.
}

TEST_F(PresentThreadTest, is_not_alive_while_the_driver_hangs) {
  FakeClock clock;
  start(clock);
  EXPECT_TRUE(present_->is_alive());
  outputs_.hang();
  clock.advance(std::chrono::seconds(21));
  EXPECT_FALSE(present_->is_alive());
  outputs_.go_on();
  while (!present_->is_alive()) std::this_thread::yield();
  // The step took 21 s and the driver did not hang, so the next step gets more time.
  outputs_.hang();
  clock.advance(std::chrono::seconds(60));
  EXPECT_TRUE(present_->is_alive());
  clock.advance(std::chrono::seconds(60));
  EXPECT_FALSE(present_->is_alive());
  outputs_.go_on();
  present_.reset();  // Destroyed first, since it borrows the clock.
}

}  // namespace
}  // namespace cyclorama::display
