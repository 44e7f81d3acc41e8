// SPDX-License-Identifier: Apache-2.0
#include "kiosk/care/fault_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cyclorama::care {
namespace {

using namespace std::chrono_literals;

const Fault kDark{"heads", "Projectors", "No picture goes to 'left'.", "Switch that projector on."};

WallSeconds at(std::chrono::seconds time) { return WallSeconds(1'800'000'000s + time); }

TEST(FaultHistory, has_a_line_for_the_begin_and_the_end_of_what_lasts) {
  FaultHistory history;
  EXPECT_FALSE(history.update({kDark}, at(0s)));
  EXPECT_FALSE(history.update({}, at(60s))) << "it lasted for an instant";
  EXPECT_FALSE(history.update({kDark}, at(100s)));
  EXPECT_TRUE(history.update({kDark}, at(130s)));
  EXPECT_TRUE(history.update({}, at(200s)));
  ASSERT_EQ(history.events().size(), 2U);
  EXPECT_FALSE(history.events()[0].is_over);
  EXPECT_EQ(history.events()[1].since, at(100s));
  EXPECT_TRUE(history.events()[1].is_over);
}

TEST(FaultHistory, keeps_the_newest_and_survives_a_restart) {
  FaultHistory history;
  for (int i = 0; i < 200; ++i) {
    const Fault fault{std::to_string(i), "Title", "Sentence.", ""};
    history.update({fault}, at(i * 1000s));
    history.update({fault}, at(i * 1000s + 40s));
    history.update({}, at(i * 1000s + 100s));
  }
  EXPECT_EQ(history.events().size(), FaultHistory::kMaxEvents);
  EXPECT_EQ(history.events().back().fault.id, "199");
  FaultHistory after;
  ASSERT_TRUE(after.read_json(history.to_json(), "history.json"));
  EXPECT_EQ(after.events(), history.events());
  for (const char* const bad : {"", "{}", R"({"version": 1, "known": 3, "events": []})"}) {
    EXPECT_FALSE(after.read_json(bad, "history.json")) << bad;
    EXPECT_EQ(after.events(), history.events());
  }
}

}  // namespace
}  // namespace cyclorama::care
