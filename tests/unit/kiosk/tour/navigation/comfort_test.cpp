// SPDX-License-Identifier: Apache-2.0
/// Measures the comfort limits on the displayed views alone, sixty a second, for arbitrary hand movements.
#include "kiosk/tour/navigation/comfort.h"

#include <gtest/gtest.h>

#include <numbers>

#include "kiosk/tour/navigation/brake.h"
#include "kiosk/tour/navigation/view_meter.h"
#include "tests/data_sets/random_hand.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;

std::shared_ptr<const WalkableArea> area_of(std::vector<Vector2d> corners,
                                            const std::vector<std::vector<Vector2d>>& holes = {}) {
  auto area = WalkableArea::make(std::move(corners), holes);
  CHECK(area);
  return std::make_shared<const WalkableArea>(*std::move(area));
}

/// Returns a hall with a pillar and a passage one metre wide, with stops in both rooms.
Site hall(double scale) {
  const auto s = [scale](double x, double z) { return Vector2d(scale * x, scale * z); };
  Site site;
  site.walking_scale = scale;
  site.area = area_of({s(-4, -4), s(4, -4), s(4, -0.5), s(6, -0.5), s(6, -3), s(10, -3), s(10, 3), s(6, 3), s(6, 0.5),
                       s(4, 0.5), s(4, 4), s(-4, 4)},
                      {{s(-0.5, -2.5), s(0.5, -2.5), s(0.5, -1.5), s(-0.5, -1.5)}});
  site.stops = {{"a", s(3, 3), 0.5}, {"b", s(8, -2), -2.0}, {"c", s(-3, -3), 3.0}};
  return site;
}

struct Shown {
  ViewPeaks peaks;
  Duration guided{};
};

/// Simulates a visit of `steps` steps, with pictures thirty times a second.
Shown visit(std::uint64_t seed, double scale, Duration step, int steps, bool odd_stamps) {
  RandomHand::Habits habits;
  habits.odd_stamps = odd_stamps;
  RandomHand hand(seed, habits);
  NavigationSettings settings;
  settings.guide_after = 2s;
  VisitWalk walk;
  TimePoint now(1000s);
  walk = after(std::move(walk), SceneOpened{"hall", hall(scale)}, now, settings);
  ViewMeter meter(scale);
  Shown shown;
  Duration until_picture{};
  for (int i = 0; i < steps; ++i) {
    now += step;
    until_picture -= step;
    if (until_picture <= Duration::zero()) {
      walk = after(std::move(walk), hand.next(33ms), now, settings);
      until_picture = 33ms;
    }
    if (hand.chance(0.001)) {
      const SteeringCommand command{hand.normal(1.0), hand.normal(1.0), hand.normal(1.0)};
      walk = after(std::move(walk), KeysPressed{command}, now, settings);
    }
    walk = after(std::move(walk), Tick{}, now, settings);
    const Walker& walker = walk.navigation.walker;
    CHECK(walk.site.area->allows(walker.position_m));
    meter.add(walker.position_m, walker.heading_rad, now);
    if (walk.navigation.steering_source == SteeringSource::kGuide) shown.guided += step;
  }
  shown.peaks = meter.peaks();
  return shown;
}

TEST(Comfort, holds_for_arbitrary_hand_movements) {
  for (const double scale : {1.0, 0.02, 25.0}) {
    for (const bool odd_stamps : {false, true}) {
      SCOPED_TRACE(scale);
      const Shown shown = visit(7, scale, 16'666'667ns, 60 * 600, odd_stamps);
      const ViewPeaks& peaks = shown.peaks;
      EXPECT_TRUE(peaks.finite);
      EXPECT_GT(peaks.distance_m, 100.0) << "they do walk";
      EXPECT_GT(shown.guided, 5s);
      EXPECT_LE(peaks.speed_m_per_s, kComfort.speed_m_per_s + 1e-6);
      EXPECT_LE(peaks.turn_rad_per_s, kComfort.turn_rad_per_s + 1e-6);
      EXPECT_LE(peaks.turn_acceleration_rad_per_s2, kComfort.turn_acceleration_rad_per_s2 + 1e-3);
      EXPECT_LE(peaks.turn_jerk_rad_per_s3, kComfort.turn_jerk_rad_per_s3 * 1.02);
      EXPECT_LE(peaks.acceleration_m_per_s2, 1.05 * kComfort.acceleration_m_per_s2) << "at walls and corners too";
    }
  }
}

TEST(Comfort, its_limits_are_not_reached_by_a_hand_at_rest) {
  NavigationSettings settings;
  settings.guide_after = Duration::zero();
  VisitWalk walk;
  TimePoint now(1s);
  walk = after(std::move(walk), SceneOpened{"hall", hall(1.0)}, now, settings);
  RandomHand hand(1, {.shake_m = 0.005, .shake_rad = 0.03, .wild = 0.0, .lost = 0.0});
  const Walker before = walk.navigation.walker;
  for (int i = 0; i < 600; ++i) {
    now += 33ms;
    PoseSeen seen = hand.next(33ms);
    seen.position_m = {hand.normal(0.005), 0.0, 1.0 + hand.normal(0.005)};
    const double yaw = hand.normal(0.02);
    seen.rotation = {std::cos(0.5 * yaw), 0.0, std::sin(0.5 * yaw), 0.0};
    walk = after(std::move(walk), seen, now, settings);
    walk = after(std::move(walk), Tick{}, now, settings);
  }
  EXPECT_EQ(walk.navigation.steering_source, SteeringSource::kTag);
  EXPECT_EQ(walk.navigation.walker.position_m, before.position_m) << "a trembling hand does not walk";
  EXPECT_EQ(walk.navigation.walker.heading_rad, before.heading_rad);
}

TEST(Comfort, slows_down_before_a_wall) {
  const auto area = area_of({{-5, -5}, {5, -5}, {5, 5}, {-5, 5}});
  Walker walker;
  ViewMeter meter(1.0);
  TimePoint now(1s);
  for (int i = 0; i < 60 * 30; ++i) {
    now += 16'666'667ns;
    walker = walked(walker, {1, 0, 0}, 16'666'667ns, WalkLimits{}, 1.0, area.get());
    meter.add(walker.position_m, walker.heading_rad, now);
  }
  EXPECT_LT(walker.position_m.y(), -4.89) << "and gets there";
  EXPECT_LE(meter.peaks().acceleration_m_per_s2, kComfort.acceleration_m_per_s2 + 1e-6);
  EXPECT_LE(meter.peaks().jerk_m_per_s3, 1.5 * kComfort.jerk_m_per_s3);
}

TEST(Comfort, slides_along_a_wall_at_the_remaining_speed) {
  const auto area = area_of({{-50, -5}, {50, -5}, {50, 5}, {-50, 5}});
  Walker walker;
  walker.heading_rad = std::numbers::pi / 4;  // To the right and ahead, towards the wall.
  for (int i = 0; i < 60 * 20; ++i) walker = walked(walker, {1, 0, 0}, 16'666'667ns, WalkLimits{}, 1.0, area.get());
  EXPECT_NEAR(walker.position_m.y(), -5.0, 0.11);
  const Vector2d velocity = walker.velocity_m_per_s.x() * right_of(walker.heading_rad) +
                            walker.velocity_m_per_s.y() * forward_of(walker.heading_rad);
  EXPECT_NEAR(velocity.x(), std::sqrt(0.5), 0.01);
  EXPECT_NEAR(velocity.y(), 0.0, 0.01);
}

TEST(Comfort, does_not_jerk_when_coming_to_rest_beside_a_wall_while_turning) {
  const auto area = area_of({{-50, -5}, {50, -5}, {50, 5}, {-50, 5}});
  Walker walker;
  walker.position_m = {-20, -4.5};
  walker.heading_rad = std::numbers::pi / 2;  // Along the wall, which is on the left.
  ViewMeter meter(1.0);
  TimePoint now(1s);
  for (int i = 0; i < 60 * 12; ++i) {
    now += 16'666'667ns;
    const SteeringCommand command = i < 600   ? SteeringCommand{0.7, -0.7, 0}
                                    : i < 630 ? SteeringCommand{1, 0, -1}
                                              : SteeringCommand{};
    walker = walked(walker, command, 16'666'667ns, WalkLimits{}, 1.0, area.get());
    meter.add(walker.position_m, walker.heading_rad, now);
  }
  EXPECT_LT(walker.position_m.y(), -4.88);
  EXPECT_TRUE(walker.is_at_rest());
  EXPECT_LE(meter.peaks().acceleration_m_per_s2, kComfort.acceleration_m_per_s2 + 1e-6);
}

TEST(ApproachSpeed, allows_stopping_in_time_and_is_smooth) {
  double before = 0.0;
  for (double distance = 0.0; distance < 2.0; distance += 1e-3) {
    const double speed = approach_speed(distance, 1.0);
    EXPECT_GE(speed, before);
    EXPECT_LE(speed * speed, 2.0 * distance + 1e-12);
    if (distance > 0.0) {
      EXPECT_LE((speed - before) * speed / 1e-3, 1.0 + 1e-2) << "deceleration at " << distance;
    }
    before = speed;
  }
  EXPECT_EQ(approach_speed(-1.0, 1.0), 0.0);
  EXPECT_EQ(approach_speed(std::nan(""), 1.0), 0.0);
}

}  // namespace
}  // namespace cyclorama::tour
