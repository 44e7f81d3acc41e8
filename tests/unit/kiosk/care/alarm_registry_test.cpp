// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/alarm_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::care {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Fault kDark{"heads", "Projectors", "No picture goes to 'left'.", "Switch that projector on."};
const Fault kHot{"temperature", "Temperature", "The warmest part has 99 °C.", "Clean the computer's vents."};
constexpr AlarmRules kRules{120s, false};
constexpr AlarmRules kQuiet{120s, true};

WallSeconds at(std::chrono::seconds time) { return WallSeconds(1'800'000'000s + time); }

TEST(AlarmRegistry, gives_one_alarm_for_a_fault_and_one_when_it_is_over) {
  AlarmRegistry registry;
  EXPECT_THAT(registry.update({kDark}, kRules, at(0s)), IsEmpty()) << "it may pass";
  EXPECT_THAT(registry.update({kDark}, kRules, at(119s)), IsEmpty());
  const auto begun = registry.update({kDark}, kRules, at(120s));
  ASSERT_THAT(begun, SizeIs(1));
  EXPECT_EQ(begun[0], (Alarm{kDark, at(0s), at(120s), false}));
  for (int minute = 3; minute < 600; ++minute)
    EXPECT_THAT(registry.update({kDark}, kRules, at(60s * minute)), IsEmpty()) << minute;
  EXPECT_THAT(registry.update({}, kRules, at(36000s)), IsEmpty()) << "it may come back";
  const auto over = registry.update({}, kRules, at(36100s));
  ASSERT_THAT(over, SizeIs(1));
  EXPECT_EQ(over[0], (Alarm{kDark, at(0s), at(36100s), true}));
  EXPECT_THAT(registry.update({}, kRules, at(40000s)), IsEmpty());
}

TEST(AlarmRegistry, counts_a_fault_that_flickers_as_one) {
  AlarmRegistry registry;
  std::size_t alarms = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::vector<Fault> present = i % 2 == 0 ? std::vector<Fault>{kDark} : std::vector<Fault>{};
    alarms += registry.update(present, kRules, at(60s * i)).size();
  }
  EXPECT_EQ(alarms, 1U);
}

TEST(AlarmRegistry, forgets_a_fault_that_passed_before_it_was_reported) {
  AlarmRegistry registry;
  EXPECT_THAT(registry.update({kDark}, kRules, at(0s)), IsEmpty());
  EXPECT_THAT(registry.update({}, kRules, at(200s)), IsEmpty());
  EXPECT_THAT(registry.update({kDark}, kRules, at(210s)), IsEmpty()) << "it counts anew";
  EXPECT_THAT(registry.update({kDark}, kRules, at(330s)), SizeIs(1));
}

TEST(AlarmRegistry, is_quiet_at_night_and_reports_in_the_morning_what_is_still_true) {
  AlarmRegistry registry;
  EXPECT_THAT(registry.update({kDark, kHot}, kQuiet, at(0s)), IsEmpty());
  EXPECT_THAT(registry.update({kDark, kHot}, kQuiet, at(3600s)), IsEmpty());
  EXPECT_THAT(registry.update({kDark}, kQuiet, at(7200s)), IsEmpty());
  const auto morning = registry.update({kDark}, kRules, at(28800s));
  ASSERT_THAT(morning, SizeIs(1));
  EXPECT_EQ(morning[0].fault, kDark);
  EXPECT_EQ(morning[0].since, at(0s));
  EXPECT_THAT(registry.update({}, kQuiet, at(90000s)), IsEmpty());
  EXPECT_THAT(registry.update({}, kRules, at(120000s)), SizeIs(1)) << "the end waits for the morning, too";
}

TEST(AlarmRegistry, survives_a_restart_without_a_second_alarm) {
  AlarmRegistry before;
  before.update({kDark}, kRules, at(0s));
  EXPECT_THAT(before.update({kDark}, kRules, at(200s)), SizeIs(1));
  AlarmRegistry after;
  ASSERT_TRUE(after.read_json(before.to_json(), "alarms.json"));
  EXPECT_THAT(after.update({kDark}, kRules, at(100000s)), IsEmpty());
  EXPECT_THAT(after.update({}, kRules, at(100200s)), SizeIs(1));
}

TEST(AlarmRegistry, neither_loses_nor_repeats_an_alarm_when_the_clock_is_set) {
  AlarmRegistry registry;
  registry.update({kDark}, kRules, at(100000s));
  registry.update({kDark}, kRules, at(0s));
  EXPECT_THAT(registry.update({kDark}, kRules, at(120s)), SizeIs(1));
  EXPECT_THAT(registry.update({kDark}, kRules, at(-100000s)), IsEmpty());
  registry.update({}, kRules, at(-100000s));
  EXPECT_THAT(registry.update({}, kRules, at(-99800s)), SizeIs(1));
}

TEST(AlarmRegistry, refuses_a_damaged_state_and_keeps_its_own) {
  AlarmRegistry registry;
  registry.update({kDark}, kRules, at(0s));
  const std::string before = registry.to_json();
  for (const char* const bad :
       {"", "{", "[]", R"({"version": 2, "faults": []})", R"({"version": 1})",
        R"({"version": 1, "faults": [{"id": "x"}]})", R"({"version": 1, "faults": [], "x": 1})"}) {
    const Status read = registry.read_json(bad, "alarms.json");
    ASSERT_FALSE(read) << bad;
    EXPECT_THAT(read.error().message(), HasSubstr("alarms.json")) << bad;
    EXPECT_EQ(registry.to_json(), before) << bad;
  }
}

}  // namespace
}  // namespace cyclorama::care
