// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walk_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/data_sets/random_hand.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

Site site() {
  Site site;
  auto area = WalkableArea::make({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, {{{1, 1}, {2, 1}, {2, 2.1}}});
  CHECK(area);
  site.area = std::make_shared<const WalkableArea>(*std::move(area));
  site.walking_scale = 1.1;
  site.start.heading_rad = 0.1;
  site.stops = {{"a stop", {3, 3}, 0.5}, {"", {-3, 2}, -2.0}};
  return site;
}

/// Returns the record of a ten-minute visit with every kind of event.
std::string recorded_visit(std::uint64_t seed) {
  NavigationSettings settings;
  settings.guide_after = 3s;
  settings.max_turn = 40s;
  settings.limits.turn_rad_per_s = 40.0 * 3.14159 / 180.0;
  std::string text = record_head(settings);
  VisitWalk walk;
  TimePoint now(1234567s);
  const auto give = [&](const WalkEvent& event) {
    walk = after(std::move(walk), event, now, settings);
    text += record_line(event, now, walk);
  };
  RandomHand hand(seed, {.odd_stamps = true});
  give(KeysPressed{{1, 0, 0}});
  give(SceneOpened{"the grotto\n of 2 words", site()});
  for (int i = 0; i < 60 * 120; ++i) {
    now += std::chrono::nanoseconds(16'000'000 + static_cast<std::int64_t>(1e6 * hand.uniform()));
    if (i % 2 == 0) give(hand.next(33ms));
    if (hand.chance(0.003)) give(KeysPressed{{hand.normal(1), hand.normal(1), hand.normal(1)}});
    if (hand.chance(0.001)) give(TrackerLeft{1});
    if (i == 3000) give(SceneOpened{"the grotto\n of 2 words", site()});
    give(Tick{});
  }
  return text;
}

TEST(WalkRecord, replays_bit_by_bit) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto record = parse_walk_record(recorded_visit(seed), "visit.walk");
    ASSERT_TRUE(record) << record.error().message();
    const WalkReplay replay = replayed(*record);
    EXPECT_FALSE(replay.difference) << *replay.difference;
    EXPECT_EQ(replay.ticks, 7200u);
    EXPECT_EQ(replay.poses, 3600u);
    EXPECT_GT(replay.peaks.distance_m, 5.0);
    EXPECT_TRUE(replay.peaks.finite);
  }
}

TEST(WalkRecord, reports_where_a_replayed_walk_differs) {
  std::string text = recorded_visit(1);
  // Another speed limit: the first step that reaches it differs.
  const std::size_t at = text.find("limits 1 ");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 9, "limits 0.9 ");
  const auto record = parse_walk_record(text, "visit.walk");
  ASSERT_TRUE(record) << record.error().message();
  const WalkReplay replay = replayed(*record);
  ASSERT_TRUE(replay.difference);
  EXPECT_THAT(*replay.difference, HasSubstr("line "));
}

TEST(WalkRecord, detects_one_changed_bit) {
  const auto record = parse_walk_record(recorded_visit(1), "visit.walk");
  ASSERT_TRUE(record);
  WalkRecord changed = *record;
  for (auto entry = changed.entries.rbegin(); entry != changed.entries.rend(); ++entry) {
    if (!entry->view) continue;
    entry->view->heading_rad = std::nextafter(entry->view->heading_rad, 10.0);
    break;
  }
  EXPECT_TRUE(replayed(changed).difference);
}

TEST(WalkRecord, ignores_a_truncated_last_line) {
  std::string text = recorded_visit(1);
  text.resize(text.size() - 7);
  const auto record = parse_walk_record(text, "visit.walk");
  ASSERT_TRUE(record) << record.error().message();
  EXPECT_FALSE(replayed(*record).difference);
}

TEST(WalkRecord, names_the_line_and_the_mistake) {
  const std::string head = record_head({});
  struct Wrong {
    std::string text;
    const char* says;
  };
  for (const Wrong& wrong : std::vector<Wrong>{
           {"", ":0: ends before"},
           {"cyclorama-walk 1\n", ":1: the line is not 'cyclorama-walk 3'"},
           {"cyclorama-walk 3\nlimits 1 2\n", ":2: the line ends too early"},
           {"cyclorama-walk 3\nlimits 1 1 1 1 1 1 0\n", ":2: the line has 0, which is not between"},
           {"cyclorama-walk 3\nspeeds 1\n", ":2: the line does not begin with 'limits'"},
           {head + "tick x\n", ":6: the line has 'x' for a number"},
           {head + "tick 1 0 0 0 0 0 0 somebody\n", "nobody who steers"},
           {head + "tick 1 nan 0 0 0 0 0 tag\n", "has nan"},
           {head + "tick 1 0 0 0 0 0 0 tag more\n", "goes on too long"},
           {head + "tick 9223372036854775807 0 0 0 0 0 0 tag\n", "has the time"},
           {head + "jump 1\n", "begins with none of"},
           {head + "left 1 -1\n", "'-1' for a number"},
           {head + "open 1 x 1 0 0 0 1 3 0 0 1 0 2 0 0\n", "leaves no room"},
           {head + "open 1 x 1 0 0 0 1 9999999999 0 0\n", "at most"},
           {head + "open 1 x 0 0 0 0 0 0\n", "has 0, which is not between"},
           {head + "open 1 x 1 9 9 0 1 4 0 0 1 0 1 1 0 1 0 0 1 1 0\n", "starts outside"},
           {head + "open 1 x 1 0.5 0.5 0 1 4 0 0 1 0 1 1 0 1 1 9 9 0 1\n", "ends too early"},
           {head + "open 1 x 1 0.5 0.5 0 1 4 0 0 1 0 1 1 0 1 1 9 9 0 1 0 1 1 0\n", "has a stop outside"},
           {head + "led 1 1025\n", "at most"},
           {head + "pose 1 1 1 1 0 0 1  0 0 0 1\n", "empty word"},
       }) {
    const auto record = parse_walk_record(wrong.text, "visit.walk");
    ASSERT_FALSE(record) << wrong.text;
    EXPECT_EQ(record.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(record.error().message(), HasSubstr("visit.walk:"));
    EXPECT_THAT(record.error().message(), HasSubstr(wrong.says));
  }
}

}  // namespace
}  // namespace cyclorama::tour
