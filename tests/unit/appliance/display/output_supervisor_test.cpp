// SPDX-License-Identifier: Apache-2.0
// An output that is lost and reopened, on the fake card.
#include "appliance/display/output_supervisor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "drivers/output/drm/drm_output.h"
#include "tests/doubles/fake_card/fake_machine.h"
#include "tests/support/plain_show.h"

namespace cyclorama::display {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;

constexpr int kWidth = 64;
constexpr int kHeight = 36;

class OutputSupervisorTest : public ::testing::Test {
 protected:
  void open() {
    auto opened = OutputSupervisor::open(plan(), &mailbox_, &clock_);
    ASSERT_TRUE(opened) << opened.error().message();
    supervisor_ = *std::move(opened);
  }
  PresentPlan plan() {
    PresentPlan plan;
    plan.open_output = [this] {
      tried_at_.push_back(clock_.now());
      output::DrmOptions options;
      options.heads = {{{"a", kWidth, kHeight}, "HDMI-A-1"}, {{"b", kWidth, kHeight}, "HDMI-A-3"}};
      options.flip_timeout = std::chrono::milliseconds(20);
      options.make_probe_runner = [this] { return machine_.probe_runner(); };
      return output::open_drm_output(options, clock_);
    };
    plan.heads.assign(2, plain_head(kWidth, kHeight));
    plan.attract = *frame_of(0, plain(32, 16, 0));
    plan.times = {std::chrono::seconds(3600), std::chrono::milliseconds(100)};
    return plan;
  }
  RefreshEvent refresh() {
    supervisor_->refresh();
    mailbox_.retired.clear([](const DisplayFrame&) {});
    return mailbox_.refreshes.pop().value_or(RefreshEvent{});
  }
  void show(std::uint64_t number, std::uint8_t code) {
    mailbox_.frames.put(frame_of(number, plain(40, 20, code)));
    for (int n = 0; n < 12; ++n) refresh();
  }
  /// Refreshes until there is an output again.
  void wait_for_output(int max_turns) {
    while (supervisor_->state().loss && max_turns-- > 0) refresh();
    ASSERT_FALSE(supervisor_->state().loss) << supervisor_->state().loss->message();
  }
  void expect_shown(int code) {
    for (const std::size_t connector : {0U, 2U}) {
      const auto wall = machine_.wall(0, connector);
      ASSERT_TRUE(wall);
      EXPECT_THAT(wall->data(), Each(AllOf(Ge(code - 1), Le(code + 1)))) << connector;
    }
  }
  std::vector<double> pauses_s() const {
    std::vector<double> pauses;
    for (std::size_t i = 1; i < tried_at_.size(); ++i) pauses.push_back(to_seconds(tried_at_[i] - tried_at_[i - 1]));
    return pauses;
  }

  FakeClock clock_;
  FakeMachine machine_{{three_projectors()}, &clock_};
  PresentMailbox mailbox_{2};
  std::vector<TimePoint> tried_at_;
  std::unique_ptr<OutputSupervisor> supervisor_;
};

TEST_F(OutputSupervisorTest, shows_the_frame_again_after_a_reset_of_the_graphics_processor) {
  open();
  show(1, 150);
  expect_shown(150);
  machine_.reset_gpu();
  EXPECT_TRUE(supervisor_->refresh());
  ASSERT_TRUE(supervisor_->state().loss);
  EXPECT_THAT(supervisor_->state().loss->message(), HasSubstr("graphics processor was reset"));
  EXPECT_EQ(supervisor_->state().losses, 1);
  EXPECT_EQ(machine_.held(), 0U);
  EXPECT_FALSE(machine_.wall(0, 0));
  wait_for_output(4);
  const RefreshEvent event = refresh();
  EXPECT_FALSE(event.is_first_of_frame);  // The frame was reported before.
  EXPECT_EQ(event.attract_share, 0.0);
  expect_shown(150);
}

TEST_F(OutputSupervisorTest, keeps_the_heading_and_shows_the_frame_that_arrived_meanwhile) {
  open();
  PlanarPicture halves(140, 20, false);
  for (int y = 0; y < 20; ++y) std::fill_n(halves.luma().at(70, y), 70, std::uint8_t{255});
  mailbox_.headings.put({0.1, 0});
  show(1, 150);
  machine_.reset_gpu();
  refresh();
  ASSERT_TRUE(supervisor_->state().loss);
  mailbox_.frames.put(frame_of(2, halves));
  wait_for_output(4);
  EXPECT_TRUE(refresh().is_first_of_frame);
  // The visitor looks a tenth of a radian to the right: white begins that far left of the middle.
  const auto wall = machine_.wall(0, 0);
  ASSERT_TRUE(wall);
  EXPECT_LT(wall->at(kWidth / 2 - 10, 18)[1], 50);
  EXPECT_GT(wall->at(kWidth / 2 - 3, 18)[1], 200);
}

TEST_F(OutputSupervisorTest, shows_patterns_on_the_reopened_output_before_it_answers) {
  open();
  show(1, 150);
  const auto put = [&](std::uint64_t order, bool is_open, std::uint8_t code) {
    auto wall = std::make_unique<PatternWall>();
    wall->order = order;
    wall->is_open = is_open;
    wall->heads.assign(2, {std::make_shared<RgbaImage>(kWidth, kHeight, code), true});
    mailbox_.patterns.replaced.take();
    mailbox_.patterns.wanted.put(std::move(wall));
  };
  const auto expect_exactly = [&](int code) {
    for (const std::size_t connector : {0U, 2U}) {
      const auto wall = machine_.wall(0, connector);
      ASSERT_TRUE(wall);
      EXPECT_THAT(wall->data(), Each(code));
    }
  };
  put(1, true, 77);
  refresh();
  PatternsShown told;
  ASSERT_TRUE(mailbox_.patterns.shown.take(&told));
  EXPECT_EQ(told.order, 1U);
  expect_exactly(77);
  machine_.reset_gpu();
  refresh();
  ASSERT_TRUE(supervisor_->state().loss);
  put(2, true, 78);
  EXPECT_FALSE(mailbox_.patterns.shown.take(&told)) << "no answer while nobody sees it";
  wait_for_output(4);
  refresh();
  refresh();
  ASSERT_TRUE(mailbox_.patterns.shown.take(&told));
  EXPECT_EQ(told.order, 2U);
  EXPECT_EQ(told.lacking, 0U);
  expect_exactly(78);
  put(3, false, 0);
  refresh();
  expect_shown(150);
}

TEST_F(OutputSupervisorTest, answers_for_a_pattern_after_repeating_a_failed_flip) {
  open();
  show(1, 150);
  auto wall = std::make_unique<PatternWall>();
  wall->order = 1;
  wall->is_open = true;
  wall->heads.assign(2, {std::make_shared<RgbaImage>(kWidth, kHeight, 99), true});
  mailbox_.patterns.wanted.put(std::move(wall));
  machine_.fail("drmModeAtomicCommit (flip)", EBUSY);
  refresh();
  PatternsShown told;
  ASSERT_TRUE(mailbox_.patterns.shown.take(&told));
  EXPECT_EQ(told.lacking, 3U);
  for (int n = 0; n < 8; ++n) refresh();
  ASSERT_TRUE(mailbox_.patterns.shown.take(&told));
  EXPECT_EQ(told.lacking, 0U);
  EXPECT_THAT(machine_.wall(0, 0)->data(), Each(99));
}

TEST_F(OutputSupervisorTest, retries_a_missing_card_with_increasing_pauses) {
  open();
  show(1, 90);
  machine_.fail("drmModeAtomicCommit (flip)", ENODEV);
  mailbox_.headings.put({0.01, 0});
  refresh();
  ASSERT_TRUE(supervisor_->state().loss);
  machine_.set_master_taken(0, true);
  const TimePoint lost_at = clock_.now();
  tried_at_ = {lost_at};
  while (clock_.now() - lost_at < std::chrono::seconds(60)) refresh();
  const std::vector<double> pauses = pauses_s();
  ASSERT_GE(pauses.size(), 15U);
  EXPECT_NEAR(pauses[0], 0.1, 0.001);
  for (std::size_t i = 1; i < pauses.size(); ++i) {
    EXPECT_GE(pauses[i], pauses[i - 1] - 0.001);
    EXPECT_LE(pauses[i], 5.001);
  }
  EXPECT_NEAR(pauses.back(), 5.0, 0.001);
  EXPECT_THAT(supervisor_->state().loss->message(), HasSubstr("belongs to another display server"));
  machine_.set_master_taken(0, false);
  wait_for_output(110);
  refresh();
  expect_shown(90);
  EXPECT_EQ(supervisor_->state().losses, 1);
}

TEST_F(OutputSupervisorTest, pauses_when_a_new_output_is_lost_at_once) {
  open();
  tried_at_ = {clock_.now()};
  while (tried_at_.size() < 9) {
    if (!supervisor_->state().loss) machine_.reset_gpu();
    refresh();
  }
  EXPECT_NEAR(pauses_s().front(), 0.1, 0.02);
  EXPECT_NEAR(pauses_s().back(), 5.0, 0.1);
  // After an output that lasted, the next is opened at once.
  wait_for_output(2);
  const TimePoint opened_at = clock_.now();
  while (clock_.now() - opened_at < std::chrono::seconds(31)) refresh();
  machine_.reset_gpu();
  tried_at_ = {clock_.now()};
  refresh();
  wait_for_output(4);
  EXPECT_NEAR(pauses_s().back(), 0.1, 0.02);
}

TEST_F(OutputSupervisorTest, recovers_whichever_call_fails_while_opening) {
  open();
  show(1, 120);
  const std::map<std::string, int> calls = machine_.calls();
  EXPECT_GT(calls.size(), 20U);
  double heading_rad = 0.01;
  for (const auto& [call, count] : calls) {
    machine_.fail("drmModeAtomicCommit (flip)", ENODEV);
    heading_rad = -heading_rad;  // A change that needs a new flip.
    mailbox_.headings.put({heading_rad, 0});
    refresh();
    ASSERT_TRUE(supervisor_->state().loss) << call;
    machine_.fail(call, EIO);
    for (int n = 0; n < 260 && (supervisor_->state().loss || !machine_.wall(0, 0) || !machine_.wall(0, 2)); ++n)
      refresh();
    ASSERT_FALSE(supervisor_->state().loss) << call;
    for (int n = 0; n < 3; ++n) refresh();  // One flip that fails, and the card's next pictures.
    expect_shown(120);
  }
  supervisor_.reset();
  EXPECT_EQ(machine_.held(), 0U);
}

TEST_F(OutputSupervisorTest, reports_why_it_cannot_start) {
  machine_.set_master_taken(0, true);
  const auto opened = OutputSupervisor::open(plan(), &mailbox_, &clock_);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code(), ErrorCode::kBusy);
}

}  // namespace
}  // namespace cyclorama::display
