// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/turnplate_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numbers>
#include <thread>

namespace cyclorama {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

TEST(TurnplateDesk, asks_through_the_listener_and_takes_one_answer) {
  TurnplateDesk desk;
  EXPECT_FALSE(desk.answer("too early"));
  std::vector<std::string> heard;
  desk.set_listener([&](const std::string& question) {
    if (heard.empty() || heard.back() != question) heard.push_back(question);
    if (!question.empty()) {
      EXPECT_TRUE(desk.answer("30.5"));
      EXPECT_FALSE(desk.answer("31")) << "the first one counts";
    }
    return true;
  });
  const auto answered = DeskOperator(&desk).answer("where?", minutes(1));
  ASSERT_TRUE(answered.has_value()) << answered.error().message();
  EXPECT_EQ(*answered, "30.5");
  EXPECT_EQ(heard, (std::vector<std::string>{"where?", ""}));
  EXPECT_FALSE(desk.answer("too late"));
}

TEST(TurnplateDesk, says_that_nobody_answers_or_that_nobody_is_there) {
  TurnplateDesk desk;
  EXPECT_EQ(desk.ask("where?", minutes(1)).error().code(), ErrorCode::kUnavailable);
  desk.set_listener([](const std::string&) { return true; });
  EXPECT_EQ(desk.ask("where?", milliseconds(1)).error().code(), ErrorCode::kTimedOut);
}

TEST(TurnplateDesk, ends_when_the_calibration_is_cancelled_while_it_waits) {
  TurnplateDesk desk;
  std::atomic<int> looks{0};
  desk.set_listener([&](const std::string&) { return ++looks < 3; });
  const auto asked = desk.ask("where?", minutes(1));
  ASSERT_FALSE(asked.has_value());
  EXPECT_EQ(asked.error().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(looks, 3);
}

TEST(TurnplateDesk, turns_a_plate_by_hand) {
  TurnplateDesk desk;
  desk.set_listener([&](const std::string& question) {
    if (!question.empty()) desk.answer(question.find("its mark") != std::string::npos ? "" : "44");
    return true;
  });
  ManualTurnplate plate(std::make_unique<DeskOperator>(&desk));
  ASSERT_TRUE(plate.home());
  ASSERT_TRUE(plate.turn_to(0.75));
  EXPECT_NEAR(*plate.angle(), 44.0 * std::numbers::pi / 180.0, 1e-12);
}

}  // namespace
}  // namespace cyclorama
