// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/visit_walk.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;

Site room(double half, const Vector2d& start = {0, 0}) {
  Site site;
  auto area = WalkableArea::make({{-half, -half}, {half, -half}, {half, half}, {-half, half}});
  CHECK(area);
  site.area = std::make_shared<const WalkableArea>(*std::move(area));
  site.start.position_m = start;
  return site;
}

/// A visit under a manual clock.
struct Visit {
  NavigationSettings settings;
  VisitWalk walk;
  TimePoint now = TimePoint(100s);
  std::uint64_t sequence = 0;

  explicit Visit(const Site& site = room(20)) { give(SceneOpened{"room", site}); }
  void give(const WalkEvent& event) { walk = after(std::move(walk), event, now, settings); }
  void see(std::uint64_t tracker, double camera_x, std::optional<std::int64_t> shutter_ns = {}) {
    PoseSeen seen;
    seen.tracker = tracker;
    seen.sequence = ++sequence;
    seen.shutter_ns = shutter_ns.value_or(to_nanoseconds(now));
    seen.found = true;
    seen.position_m = {camera_x, 0.0, 1.0};
    seen.rotation = {1.0, 0.0, 0.0, 0.0};
    give(seen);
  }
  void hold(std::uint64_t tracker, double camera_x, Duration how_long) {
    for (const TimePoint end = now + how_long; now < end;) {
      see(tracker, camera_x);
      wait(25ms);
    }
  }
  void wait(Duration how_long) {
    for (const TimePoint end = now + how_long; now < end;) {
      now += 5ms;
      give(Tick{});
    }
  }
  [[nodiscard]] double sideways() const { return walk.navigation.walker.velocity_m_per_s.x(); }
  [[nodiscard]] SteeringSource steering_source() const { return walk.navigation.steering_source; }
};

TEST(WandSelector, keeps_the_first_tracker_until_it_has_lost_the_tag_for_a_second) {
  WandSelector choice;
  const TimePoint now(10s);
  EXPECT_TRUE(choice.sees_tag(1, now));
  EXPECT_FALSE(choice.sees_tag(2, now + 500ms));
  EXPECT_TRUE(choice.sees_tag(1, now + 900ms));
  EXPECT_FALSE(choice.sees_tag(2, now + 1800ms));
  EXPECT_TRUE(choice.sees_tag(2, now + 2s));
  EXPECT_FALSE(choice.sees_tag(1, now + 2100ms));
  choice.leaves(1);
  EXPECT_FALSE(choice.sees_tag(1, now + 2200ms));
  choice.leaves(2);
  EXPECT_TRUE(choice.sees_tag(1, now + 2300ms));
}

TEST(PoseOrder, skips_repeated_and_late_poses) {
  PoseOrder order;
  EXPECT_TRUE(order.is_news(1, 1000, TimePoint(1s)));
  EXPECT_FALSE(order.is_news(1, 1000, TimePoint(2s))) << "the same, however late";
  EXPECT_FALSE(order.is_news(2, 900, TimePoint(1s + 10ms)));
  EXPECT_TRUE(order.is_news(2, 1000, TimePoint(1s + 20ms))) << "two pictures of one instant";
}

TEST(PoseOrder, accepts_a_clock_that_has_jumped) {
  PoseOrder order;
  EXPECT_TRUE(order.is_news(1, 1'000'000, TimePoint(1s)));
  EXPECT_TRUE(order.is_news(2, 9'000'000'000, TimePoint(1s + 33ms))) << "ahead";
  EXPECT_FALSE(order.is_news(3, 3'000'000, TimePoint(1s + 66ms))) << "and back: perhaps just late";
  EXPECT_TRUE(order.is_news(9, 9'000'000, TimePoint(1s + 266ms))) << "no, that is its time now";
  EXPECT_TRUE(order.is_news(10, 10'000'000, TimePoint(1s + 300ms)));
}

TEST(VisitWalk, follows_the_first_of_two_wands_and_the_second_when_the_first_is_gone) {
  Visit visit;
  for (int i = 0; i < 40; ++i) {
    visit.see(1, -0.4);
    visit.see(2, 0.4);
    visit.wait(30ms);
  }
  EXPECT_GT(visit.sideways(), 0.6) << "to the right, as the first says";
  visit.hold(2, 0.4, 900ms);
  EXPECT_EQ(visit.sideways(), 0.0) << "the first may come back";
  visit.hold(2, 0.4, 1500ms);
  EXPECT_LT(visit.sideways(), -0.6);
}

TEST(VisitWalk, changes_to_the_second_tracker_at_once_when_the_first_leaves) {
  Visit visit;
  visit.hold(1, -0.4, 1s);
  visit.give(TrackerLeft{1});
  visit.hold(2, 0.4, 1200ms);
  EXPECT_LT(visit.sideways(), -0.6);
}

TEST(VisitWalk, continues_after_a_trackers_clock_jumped_ahead_and_back) {
  Visit visit;
  visit.hold(1, -0.4, 1s);
  visit.see(1, -0.4, to_nanoseconds(visit.now) + 3'600'000'000'000);
  visit.wait(30ms);
  visit.hold(1, -0.4, 2s);
  EXPECT_GT(visit.sideways(), 0.6) << "not deaf for the hour that the stamp was ahead";
}

TEST(VisitWalk, keeps_its_position_in_the_same_scene_and_starts_anew_in_another) {
  Visit visit;
  visit.hold(1, -0.4, 3s);
  visit.wait(2s);
  const Vector2d position = visit.walk.navigation.walker.position_m;
  EXPECT_GT(position.x(), 1.0);
  visit.give(SceneOpened{"room", room(20)});
  EXPECT_EQ(visit.walk.navigation.walker.position_m, position);
  visit.give(SceneOpened{"room", room(0.5)});
  EXPECT_TRUE(visit.walk.site.area->allows(visit.walk.navigation.walker.position_m)) << "what is left of the room";
  visit.give(SceneOpened{"cave", room(20, {3, 4})});
  EXPECT_EQ(visit.walk.navigation.walker.position_m, Vector2d(3, 4));
}

TEST(VisitWalk, does_nothing_before_there_is_a_scene) {
  VisitWalk walk;
  const NavigationSettings settings;
  walk = after(std::move(walk), Tick{}, TimePoint(1s), settings);
  walk = after(std::move(walk), KeysPressed{{1, 0, 0}}, TimePoint(2s), settings);
  walk = after(std::move(walk), PoseSeen{1, 1, 1, true, {0, 0, 1}, {1, 0, 0, 0}}, TimePoint(3s), settings);
  EXPECT_FALSE(walk.open);
  EXPECT_FALSE(walk.navigation.tag_seen_at);
}

TEST(Turn, ends_after_its_time_and_the_next_one_begins_after_a_pause) {
  Visit visit;
  visit.settings.max_turn = 20s;
  visit.settings.turn_pause = 5s;
  visit.hold(1, -0.4, 15s);
  EXPECT_EQ(visit.steering_source(), SteeringSource::kTag);
  EXPECT_NEAR(to_seconds(*turn_left(visit.walk.navigation, visit.settings, visit.now)), 5.0, 0.1);
  visit.hold(1, -0.4, 6s);
  EXPECT_EQ(visit.steering_source(), SteeringSource::kGuide) << "though the wand is still held";
  visit.hold(1, -0.4, 6s);
  EXPECT_EQ(visit.steering_source(), SteeringSource::kTag) << "the next visitor has it";
  EXPECT_GT(*turn_left(visit.walk.navigation, visit.settings, visit.now), 15s);
}

TEST(Turn, ends_when_the_wand_is_put_down) {
  Visit visit;
  visit.settings.max_turn = 10s;
  visit.settings.turn_pause = 60s;
  visit.hold(1, -0.4, 11s);
  EXPECT_EQ(visit.steering_source(), SteeringSource::kGuide);
  visit.wait(1500ms);
  visit.hold(1, -0.4, 500ms);
  EXPECT_EQ(visit.steering_source(), SteeringSource::kTag) << "handed over: no need to wait for the pause";
}

TEST(Turn, passes_to_the_next_visitor_after_ten_seconds_without_a_wand) {
  Visit visit;
  visit.settings.max_turn = 60s;
  visit.hold(1, -0.4, 30s);
  visit.wait(11s);
  EXPECT_FALSE(turn_left(visit.walk.navigation, visit.settings, visit.now));
  visit.hold(1, -0.4, 1s);
  EXPECT_GT(*turn_left(visit.walk.navigation, visit.settings, visit.now), 58s);
}

TEST(Turn, does_not_limit_keys_and_by_default_nobody) {
  Visit visit;
  visit.hold(1, -0.1, 3600s);
  EXPECT_EQ(visit.steering_source(), SteeringSource::kTag);
  visit.settings.max_turn = 1s;
  for (int i = 0; i < 100; ++i) {
    visit.give(KeysPressed{{0, 0, 1}});
    visit.wait(100ms);
    ASSERT_EQ(visit.steering_source(), SteeringSource::kKeys);
  }
}

TEST(VisitWalk, counts_stops_from_where_the_visitor_was_last_or_stands) {
  VisitWalk walk;
  EXPECT_FALSE(stop_after(walk, 1));
  Site site;
  auto area = WalkableArea::make({{-10, -10}, {10, -10}, {10, 10}, {-10, 10}});
  ASSERT_TRUE(area);
  site.area = std::make_shared<const WalkableArea>(*std::move(area));
  site.stops = {{"a", {3, 0}, 0.0}, {"b", {-3, 0}, 0.0}, {"c", {0, 5}, 0.0}};
  site.start.position_m = {-1, 0};
  const TimePoint now{};
  walk = after(std::move(walk), SceneOpened{"s", site}, now, {});
  EXPECT_EQ(stop_after(walk, 1), 1u) << "the nearest";
  walk = after(std::move(walk), CutToStop{2}, now, {});
  EXPECT_EQ(stop_after(walk, 1), 0u) << "after the last comes the first";
  EXPECT_EQ(stop_after(walk, -1), 1u);
  walk = after(std::move(walk), SceneOpened{"s", site}, now, {});
  EXPECT_EQ(stop_after(walk, 1), 0u) << "the visitor stands at the last one, whatever was forgotten";
}

}  // namespace
}  // namespace cyclorama::tour
