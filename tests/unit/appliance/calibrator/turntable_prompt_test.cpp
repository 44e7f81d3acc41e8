// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/turntable_prompt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numbers>
#include <thread>

namespace cyclorama::calibrator {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

TEST(TurntablePrompt, asks_through_the_listener_and_accepts_one_answer) {
  TurntablePrompt prompt;
  EXPECT_FALSE(prompt.answer("too early"));
  std::vector<std::string> heard;
  prompt.set_listener([&](const std::string& question) {
    if (heard.empty() || heard.back() != question) heard.push_back(question);
    if (!question.empty()) {
      EXPECT_TRUE(prompt.answer("30.5"));
      EXPECT_FALSE(prompt.answer("31")) << "the first one counts";
    }
    return true;
  });
  const auto answered = PromptOperator(&prompt).answer("where?", minutes(1));
  ASSERT_TRUE(answered.has_value()) << answered.error().message();
  EXPECT_EQ(*answered, "30.5");
  EXPECT_EQ(heard, (std::vector<std::string>{"where?", ""}));
  EXPECT_FALSE(prompt.answer("too late"));
}

TEST(TurntablePrompt, reports_a_missing_answer_and_a_missing_listener) {
  TurntablePrompt prompt;
  EXPECT_EQ(prompt.ask("where?", minutes(1)).error().code(), ErrorCode::kUnavailable);
  prompt.set_listener([](const std::string&) { return true; });
  EXPECT_EQ(prompt.ask("where?", milliseconds(1)).error().code(), ErrorCode::kTimedOut);
}

TEST(TurntablePrompt, ends_when_the_calibration_is_cancelled) {
  TurntablePrompt prompt;
  std::atomic<int> looks{0};
  prompt.set_listener([&](const std::string&) { return ++looks < 3; });
  const auto asked = prompt.ask("where?", minutes(1));
  ASSERT_FALSE(asked.has_value());
  EXPECT_EQ(asked.error().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(looks, 3);
}

TEST(TurntablePrompt, lets_a_person_turn_a_manual_turntable) {
  TurntablePrompt prompt;
  prompt.set_listener([&](const std::string& question) {
    if (!question.empty()) prompt.answer(question.find("its mark") != std::string::npos ? "" : "44");
    return true;
  });
  turntable::ManualTurntable turntable(std::make_unique<PromptOperator>(&prompt));
  ASSERT_TRUE(turntable.home());
  ASSERT_TRUE(turntable.turn_to(0.75));
  EXPECT_NEAR(*turntable.angle(), 44.0 * std::numbers::pi / 180.0, 1e-12);
}

}  // namespace
}  // namespace cyclorama::calibrator
