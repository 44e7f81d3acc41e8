// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/navigator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using TagPose = RigidTransform<frame::Camera, frame::Tag>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Site square_site() {
  Site site;
  auto area = WalkableArea::make({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
  CHECK(area);
  site.area = std::make_shared<const WalkableArea>(*std::move(area));
  return site;
}

TagPose tag_at(double camera_x, double distance, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY())), {camera_x, 0, distance}};
}

/// Advances a navigation and checks invariants: never NaN, never too fast, never a jump.
struct Walk {
  Site site = square_site();
  NavigationSettings settings;
  Navigation state = started(site);
  TimePoint now = TimePoint(100s);

  void run(Duration how_long, Duration tick = 16ms) {
    for (const TimePoint end = now + how_long; now < end;) step(tick);
  }
  void step(Duration tick) {
    now += tick;
    const Walker before = state.walker;
    state = advanced(std::move(state), site, settings, now);
    const Walker& after = state.walker;
    const double seconds = to_seconds(std::min(tick, kMaxStep));
    const WalkLimits& limits = settings.limits;
    ASSERT_TRUE(after.position_m.allFinite() && after.velocity_m_per_s.allFinite());
    ASSERT_TRUE(std::isfinite(after.heading_rad) && std::isfinite(after.turn_rate_rad_per_s));
    ASSERT_LE(after.velocity_m_per_s.norm(), limits.forward_m_per_s + 1e-9);
    ASSERT_LE((after.position_m - before.position_m).norm(),
              (limits.forward_m_per_s * seconds + 1e-9) * site.walking_scale);
    ASSERT_LE(std::abs(after.turn_rate_rad_per_s), limits.turn_rad_per_s + 1e-9);
    ASSERT_LE(std::abs(after.heading_rad - before.heading_rad), limits.turn_rad_per_s * seconds + 1e-9);
    ASSERT_LE(std::abs(after.turn_rate_rad_per_s - before.turn_rate_rad_per_s),
              limits.turn_acceleration_rad_per_s2 * seconds + 1e-6);
    // Walls may slow the walker down faster than the limit, or deflect it; nothing may accelerate it faster.
    ASSERT_LE(after.velocity_m_per_s.norm() - before.velocity_m_per_s.norm(),
              std::numbers::sqrt2 * limits.acceleration_m_per_s2 * seconds + 1e-6);
    if (site.area) {
      ASSERT_TRUE(site.area->allows(after.position_m));
      if (is_far_from_walls(before.position_m)) {
        ASSERT_LE((after.velocity_m_per_s - before.velocity_m_per_s).cwiseAbs().maxCoeff(),
                  limits.acceleration_m_per_s2 * seconds + 1e-6);
        ASSERT_LE((after.acceleration_m_per_s2 - before.acceleration_m_per_s2).cwiseAbs().maxCoeff(),
                  limits.jerk_m_per_s3 * seconds + 0.0061);
      }
    }
  }
  [[nodiscard]] bool is_far_from_walls(const Vector2d& position) const {
    const double far = 0.2 * site.walking_scale;
    for (int i = 0; i < 16; ++i) {
      const Vector2d beside = position + far * Vector2d(std::cos(0.4 * i), std::sin(0.4 * i));
      if (!site.area->allows(beside) || !site.area->sees(position, beside)) return false;
    }
    return true;
  }
  void see(const TagPose& pose) { state = with_tag(std::move(state), pose, now, settings); }
  void hold(const TagPose& pose, Duration how_long) {
    for (const TimePoint end = now + how_long; now < end;) {
      see(pose);
      run(33ms, 11ms);
    }
  }
};

TEST(Navigator, walks_in_the_direction_of_view) {
  Walk walk;
  walk.site.start.heading_rad = walk.state.walker.heading_rad = std::numbers::pi / 2;  // To the right: along +x.
  walk.hold(tag_at(0, 0.5, 0), 2s);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kTag);
  EXPECT_GT(walk.state.walker.position_m.x(), 1.0);
  EXPECT_NEAR(walk.state.walker.position_m.y(), 0.0, 1e-9);
}

TEST(Navigator, turns_right_with_a_tag_that_points_right) {
  Walk walk;
  walk.hold(tag_at(0, 1, 0.6), 1s);
  EXPECT_GT(walk.state.walker.heading_rad, 0.3);
  walk.hold(tag_at(0, 1, -0.6), 2s);
  EXPECT_LT(walk.state.walker.turn_rate_rad_per_s, -0.5);
}

TEST(Navigator, comes_to_rest_within_a_second_after_the_tag_is_lost) {
  Walk walk;
  walk.hold(tag_at(-0.5, 0.3, 0.8), 1500ms);
  EXPECT_GT(walk.state.walker.velocity_m_per_s.norm(), 0.8);
  walk.run(100ms);
  EXPECT_FALSE(walk.state.walker.is_at_rest()) << "a glide, not a stop";
  walk.run(867ms);
  EXPECT_TRUE(walk.state.walker.is_at_rest());
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kNobody);
}

TEST(Navigator, is_not_affected_by_one_missed_picture) {
  Walk walk;
  walk.hold(tag_at(0, 0.3, 0), 1s);
  const double speed = walk.state.walker.velocity_m_per_s.norm();
  walk.run(66ms);
  EXPECT_DOUBLE_EQ(walk.state.walker.velocity_m_per_s.norm(), speed);
}

TEST(Navigator, does_not_jump_when_the_tag_is_found_again) {
  Walk walk;  // The limits are checked at every step.
  for (int i = 0; i < 20; ++i) {
    walk.hold(tag_at(i % 2 == 0 ? 0.6 : -0.6, i % 3 == 0 ? 0.2 : 2.0, i % 2 == 0 ? -1.0 : 1.0), 300ms);
    walk.run(i * 100ms);
  }
}

TEST(Navigator, prefers_keys_while_they_are_pressed_and_forgets_them_after_300_ms) {
  Walk walk;
  walk.hold(tag_at(0, 0.4, 0), 500ms);
  for (int i = 0; i < 10; ++i) {
    walk.see(tag_at(0, 0.4, 0));
    walk.state = with_keys(std::move(walk.state), {-1, 0, 0}, walk.now);
    walk.run(100ms);
    EXPECT_EQ(walk.state.steering_source, SteeringSource::kKeys);
  }
  EXPECT_LT(walk.state.walker.velocity_m_per_s.y(), -0.9);
  walk.hold(tag_at(0, 0.4, 0), 1600ms);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kTag);
  EXPECT_GT(walk.state.walker.velocity_m_per_s.y(), 0.5);
}

TEST(Navigator, stops_when_the_connection_of_the_keys_is_lost) {
  Walk walk;
  walk.state = with_keys(std::move(walk.state), {1, 0, 1}, walk.now);
  walk.run(290ms);
  EXPECT_GT(walk.state.walker.velocity_m_per_s.y(), 0.3);
  walk.run(1s);
  EXPECT_TRUE(walk.state.walker.is_at_rest());
}

TEST(Navigator, releases_keys_at_once_on_request) {
  Walk walk;
  walk.state = with_keys(std::move(walk.state), {1, 0, 0}, walk.now);
  walk.run(50ms);
  walk.state = with_keys(std::move(walk.state), {}, walk.now);
  walk.run(16ms);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kNobody);
}

TEST(Navigator, starts_the_guide_when_nobody_steers_and_hands_over_smoothly) {
  Walk walk;
  walk.settings.guide_after = 10s;
  walk.site.stops = {{"a", {3, 3}, 0.5}, {"b", {-3, 2}, -2.0}};
  walk.run(9900ms);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kNobody);
  walk.run(4s);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kGuide);
  EXPECT_FALSE(walk.state.walker.is_at_rest());
  walk.hold(tag_at(0, 0.4, 0), 500ms);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kTag);
  walk.run(5s);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kNobody);
}

TEST(Navigator, leads_to_every_stop_and_turns_to_its_heading) {
  Walk walk;
  walk.settings.guide_after = 1s;
  walk.site.stops = {{"a", {3, 3}, 0.5}, {"b", {-3, 2}, -2.0}, {"c", {0, -4}, 3.0}};
  std::vector<bool> seen(3, false);
  for (int i = 0; i < 1200; ++i) {
    walk.run(100ms, 50ms);
    for (std::size_t s = 0; s < 3; ++s) {
      const GuideStop& stop = walk.site.stops[s];
      const double off = std::remainder(stop.heading_rad - walk.state.walker.heading_rad, 2 * std::numbers::pi);
      if ((walk.state.walker.position_m - stop.position_m).norm() < 0.1 && std::abs(off) < 0.2) seen[s] = true;
    }
  }
  EXPECT_EQ(seen, std::vector<bool>(3, true));
}

TEST(Navigator, leads_round_corners) {
  Walk walk;
  auto area = WalkableArea::make({{0, 0}, {10, 0}, {10, 3}, {3, 3}, {3, 10}, {0, 10}});
  ASSERT_TRUE(area);
  walk.site.area = std::make_shared<const WalkableArea>(*std::move(area));
  walk.site.start.position_m = {9, 2};
  walk.site.stops = {{"behind the corner", {2, 9}, 0.0}};
  walk.state = started(walk.site);
  walk.settings.guide_after = 1s;
  walk.run(60s, 20ms);
  EXPECT_LT((walk.state.walker.position_m - Vector2d(2, 9)).norm(), 0.2);
}

TEST(Navigator, leads_to_a_stop_on_request_and_then_leaves_the_visitor_alone) {
  Walk walk;
  walk.site.stops = {{"a", {3, 3}, 0.5}, {"b", {-3, 2}, -2.0}};
  walk.hold(tag_at(0, 1, 0), 1s);
  walk.state = led(std::move(walk.state), walk.site, 1, walk.now);
  walk.run(3s);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kGuide) << "without waiting for the guide's time";
  walk.run(30s);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kNobody);
  EXPECT_LT((walk.state.walker.position_m - Vector2d(-3, 2)).norm(), 0.2);
  EXPECT_NEAR(walk.state.walker.heading_rad, -2.0, 0.05) << "no glance around";
  EXPECT_EQ(walk.state.stop, 1u);
}

TEST(Navigator, lets_a_visitor_who_is_led_steer_at_any_time) {
  Walk walk;
  walk.site.stops = {{"a", {3, 3}, 0.5}};
  walk.state = led(std::move(walk.state), walk.site, 0, walk.now);
  walk.run(1s);
  walk.hold(tag_at(0, 0.4, 0), 500ms);
  EXPECT_EQ(walk.state.steering_source, SteeringSource::kTag);
  walk.run(5s);
  EXPECT_TRUE(walk.state.walker.is_at_rest()) << "not led any more";
}

TEST(Navigator, walks_the_way_that_the_tour_prescribes_in_both_directions) {
  for (const std::size_t target : {0U, 1U}) {
    Walk walk;
    walk.site.stops = {{"a", {3, 0}, 0.0}, {"b", {-3, 0}, 0.0}};
    walk.site.ways = {{0, 1, {{2, 4}, {-2, 4}}, false}};
    walk.state = cut(std::move(walk.state), walk.site, 1 - target, walk.now);
    walk.state = led(std::move(walk.state), walk.site, target, walk.now);
    double farthest = 0.0;
    for (int i = 0; i < 400; ++i) {
      walk.run(100ms, 50ms);
      farthest = std::max(farthest, walk.state.walker.position_m.y());
    }
    EXPECT_GT(farthest, 3.5);
    EXPECT_LT((walk.state.walker.position_m - walk.site.stops[target].position_m).norm(), 0.2);
  }
}

TEST(Navigator, never_exceeds_the_pace_of_the_tour) {
  Walk walk;
  walk.site.stops = {{"a", {4, 4}, 3.0}};
  walk.site.pace = 0.3;
  walk.site.turn_pace = 0.5;
  walk.state = led(std::move(walk.state), walk.site, 0, walk.now);
  for (int i = 0; i < 100; ++i) {
    walk.run(100ms, 50ms);
    EXPECT_LE(walk.state.walker.velocity_m_per_s.norm(), 0.3 * WalkLimits{}.forward_m_per_s + 1e-9);
    EXPECT_LE(std::abs(walk.state.walker.turn_rate_rad_per_s), 0.5 * WalkLimits{}.turn_rad_per_s + 1e-9);
  }
}

TEST(Navigator, with_reduced_motion_rests_where_a_cut_is_due) {
  Walk walk;
  walk.settings.guide_after = 1s;
  walk.site.stops = {{"a", {3, 3}, 0.5}, {"b", {-3, 2}, -2.0, "b", 3s}};
  walk.site.reduced_motion = true;
  walk.run(5s);
  EXPECT_TRUE(walk.state.walker.position_m.isZero(0.0)) << "the guide does not walk";
  ASSERT_EQ(guide_cut(walk.state.guide, walk.state.walker, walk.site, walk.now), 1u) << "the nearest stop";
  walk.state = cut(std::move(walk.state), walk.site, 1, walk.now);
  EXPECT_EQ(walk.state.walker.position_m, Vector2d(-3, 2));
  walk.run(2s);
  EXPECT_FALSE(guide_cut(walk.state.guide, walk.state.walker, walk.site, walk.now)) << "the guide stays there";
  walk.run(2s);
  EXPECT_EQ(guide_cut(walk.state.guide, walk.state.walker, walk.site, walk.now), 0u);
}

TEST(Navigator, looks_around_in_a_scene_without_stops) {
  Walk walk;
  walk.settings.guide_after = 1s;
  walk.run(10s);
  EXPECT_GT(walk.state.walker.heading_rad, 0.5);
  EXPECT_EQ(walk.state.walker.position_m, Vector2d(0, 0));
}

TEST(Navigator, has_no_guide_if_disabled_or_while_a_visitor_holds_still) {
  Walk off;
  off.settings.guide_after = 0s;
  off.run(300s, 90ms);
  EXPECT_EQ(off.state.steering_source, SteeringSource::kNobody);
  Walk held;
  held.settings.guide_after = 5s;
  held.hold(tag_at(0, 1, 0), 30s);
  EXPECT_EQ(held.state.steering_source, SteeringSource::kTag);
  held.hold(tag_at(0, 1, 0), 15s);
  EXPECT_EQ(held.state.steering_source, SteeringSource::kGuide) << "forgotten on its stand";
}

TEST(Navigator, ignores_invalid_measurements) {
  Walk walk;
  walk.hold(tag_at(0, 0.5, 0), 200ms);
  walk.step(10ms);
  const Navigation before = walk.state;
  walk.see(tag_at(kNaN, 1, 0));
  walk.see(tag_at(0, -1, 0));
  walk.see(tag_at(0, 1e9, 0));
  walk.see({Eigen::Quaterniond(kNaN, 0, 0, 0), {0, 0, 1}});
  EXPECT_EQ(walk.state.tag_command, before.tag_command);
  EXPECT_EQ(walk.state.tag_seen_at, before.tag_seen_at);
  walk.state = with_keys(std::move(walk.state), {kNaN, 1e300, -1e300}, walk.now);
  walk.run(200ms);
  EXPECT_EQ(walk.state.keys_command.forward, 0.0);
}

TEST(Navigator, stands_still_when_time_runs_backwards_and_does_not_jump_after_a_stall) {
  Walk walk;
  walk.hold(tag_at(0, 0.3, 0.8), 1s);
  const Walker before = walk.state.walker;
  walk.state = advanced(std::move(walk.state), walk.site, walk.settings, walk.now - 10s);
  EXPECT_EQ(walk.state.walker.position_m, before.position_m);
  walk.see(tag_at(0, 0.3, 0.8));
  const TimePoint seen = *walk.state.tag_seen_at;
  walk.state = with_tag(std::move(walk.state), tag_at(1, 1, -1), seen - 5s, walk.settings);
  EXPECT_EQ(*walk.state.tag_seen_at, seen);
  walk.step(3600s);
  EXPECT_LT((walk.state.walker.position_m - before.position_m).norm(), 0.11);
}

TEST(Navigator, only_turns_without_a_walkable_area) {
  Walk walk;
  walk.site.area = nullptr;
  walk.hold(tag_at(-1, 0.3, 1.0), 1s);
  EXPECT_EQ(walk.state.walker.position_m, Vector2d(0, 0));
  EXPECT_GT(walk.state.walker.heading_rad, 0.1);
}

/// Random input: hands that appear, jump, vanish and are joined by keys, ticks of all lengths, a clock that goes back.
void walk_at_random(unsigned seed, double scale) {
  Walk walk;
  walk.site.walking_scale = scale;
  walk.settings.guide_after = 3s;
  walk.site.stops = {{"a", {3, 3}, 0.5}, {"b", {-3, 2}, -2.0}};
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> dice(0, 999);
  TagPose pose = tag_at(0, 1, 0);
  bool tag = true;
  for (int i = 0; i < 20'000 && !::testing::Test::HasFatalFailure(); ++i) {
    const int n = dice(random);
    if (n < 10) pose = tag_at(normal(random), 1.0 + normal(random), 2.0 * normal(random));
    if (n == 11) tag = !tag;
    if (tag && n % 2 == 0) walk.see(pose);
    if (n > 990)
      walk.state = with_keys(std::move(walk.state), {normal(random), normal(random), normal(random)}, walk.now);
    if (n == 20) walk.now -= 50ms;
    walk.step(n == 13 ? Duration(2s) : Duration(std::chrono::microseconds(1 + 30 * n)));
  }
}

TEST(Navigator, keeps_every_limit_for_600000_random_steps) {
  for (const double scale : {1.0, 0.01, 30.0}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", scale " << scale);
      ASSERT_NO_FATAL_FAILURE(walk_at_random(seed, scale));
    }
  }
}

}  // namespace
}  // namespace cyclorama::tour
