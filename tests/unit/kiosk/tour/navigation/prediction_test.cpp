// SPDX-License-Identifier: Apache-2.0
/// Compares predictions with the walk that follows: both take the tour's steps, so that they must agree to the bit.
#include "kiosk/tour/navigation/prediction.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/data_sets/random_hand.h"

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2d;

constexpr Duration kAhead = 24 * kWalkStep;

std::shared_ptr<const WalkableArea> area_of(std::vector<Vector2d> corners,
                                            const std::vector<std::vector<Vector2d>>& holes = {}) {
  auto area = WalkableArea::make(std::move(corners), holes);
  CHECK(area);
  return std::make_shared<const WalkableArea>(*std::move(area));
}

/// A room of 10 m with a pillar and a niche, and a stop on either side of the pillar.
Site room() {
  Site site;
  site.area = area_of({{-5, -5}, {5, -5}, {5, 0}, {4, 0}, {4, 0.6}, {5, 0.6}, {5, 5}, {-5, 5}},
                      {{{-1, -3}, {1, -3}, {1, -2}, {0, -1.5}, {-1, -2}}});
  site.start.position_m = {0, 2};
  site.stops = {{"before", {0, -0.6}, 0.4}, {"behind", {0, -4}, 2.5}};
  return site;
}

struct Visit {
  NavigationSettings settings;
  VisitWalk walk;
  TimePoint now = TimePoint(100s);
  std::optional<SteeringCommand> keys{};  ///< Pressed with each step.
  std::optional<double> wand_x{};         ///< Position of the wand, seen with each step.
  std::uint64_t sequence = 0;

  explicit Visit(const Site& site = room()) { give(SceneOpened{"room", site}); }
  void give(const WalkEvent& event) { walk = after(std::move(walk), event, now, settings); }
  void see() {
    PoseSeen seen;
    seen.sequence = ++sequence;
    seen.shutter_ns = to_nanoseconds(now);
    seen.found = true;
    seen.position_m = {*wand_x, 0.0, 1.0};
    seen.rotation = {1.0, 0.0, 0.0, 0.0};
    give(seen);
  }
  void step() {
    now += kWalkStep;
    if (keys) give(KeysPressed{*keys});
    if (wand_x) see();
    give(Tick{});
  }
  void go(Duration how_long) {
    for (const TimePoint end = now + how_long; now < end;) step();
  }
  [[nodiscard]] const Walker& walker() const { return walk.navigation.walker; }
  [[nodiscard]] Walker ahead(Duration how_far = kAhead) const { return predicted(walk, now + how_far, settings); }
};

void expect_same(const Walker& a, const Walker& b) {
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.heading_rad, b.heading_rad);
}

/// Walks for `how_long` and expects each step to be as predicted. Returns the largest distance predicted.
double expect_exact(Visit* visit, Duration how_long) {
  std::vector<Walker> expected;
  std::size_t checked = 0;
  double farthest_m = 0.0;
  const auto steps = static_cast<std::size_t>(kAhead / kWalkStep);
  for (const TimePoint end = visit->now + how_long; visit->now < end; visit->step()) {
    if (expected.size() >= steps) expect_same(expected[expected.size() - steps], visit->walker()), ++checked;
    expected.push_back(visit->ahead());
    farthest_m = std::max(farthest_m, (expected.back().position_m - visit->walker().position_m).norm());
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_GT(checked, 20u);
  return farthest_m;
}

TEST(Prediction, is_exact_for_a_steady_walk_and_turn) {
  Visit visit;
  visit.keys = SteeringCommand{0.5, 0.3, 0.4};
  visit.step();
  EXPECT_GT(expect_exact(&visit, 3s), 0.2);
}

TEST(Prediction, is_exact_for_a_wand_that_is_held_still) {
  Visit visit;
  visit.settings.tag_smoothing = 0s;  // Otherwise the command grows towards the wand's for some pictures more.
  visit.wand_x = -0.4;
  visit.step();
  EXPECT_GT(expect_exact(&visit, 2s), 0.2);
}

TEST(Prediction, brakes_before_a_wall_and_slides_along_it_as_the_walk_does) {
  Visit visit;
  visit.keys = SteeringCommand{1.0, 0.2, 0.0};
  visit.step();
  expect_exact(&visit, 9s);
  EXPECT_LT(visit.walker().position_m.y(), -1.0) << "beside or behind the pillar";
}

TEST(Prediction, is_exact_for_the_guide_along_its_path_and_at_its_stops) {
  Visit visit;
  visit.settings.guide_after = 1s;
  EXPECT_GT(expect_exact(&visit, 20s), 0.1);
  EXPECT_EQ(visit.walk.navigation.steering_source, SteeringSource::kGuide);
  EXPECT_EQ(visit.walk.navigation.guide.stop, 1u) << "it has been at the first";
}

TEST(Prediction, glides_to_rest_after_a_wand_was_lost) {
  Visit visit;
  visit.wand_x = -0.4;
  visit.go(2s);
  EXPECT_GT(visit.ahead(1s).velocity_m_per_s.norm(), 0.5) << "the wand is in sight, so it stays";
  visit.wand_x.reset();
  visit.go(kTagHeld + 2 * kWalkStep);
  EXPECT_FALSE(visit.walker().is_at_rest());
  expect_exact(&visit, 1500ms);
  EXPECT_TRUE(visit.walker().is_at_rest());
}

TEST(Prediction, ends_a_visitors_turn_when_it_will_end) {
  Visit visit;
  visit.settings.max_turn = 2s;
  visit.settings.tag_smoothing = 0s;
  visit.wand_x = -0.4;
  visit.go(1s);
  expect_exact(&visit, 3s);
  EXPECT_EQ(visit.walk.navigation.steering_source, SteeringSource::kGuide);
}

TEST(Prediction, of_a_visitor_at_rest_is_that_very_pose) {
  Visit visit;
  visit.keys = SteeringCommand{0.7, 0.1, 0.9};
  visit.go(1s);
  visit.keys.reset();
  visit.go(2s);
  ASSERT_TRUE(visit.walker().is_at_rest());
  for (const Duration ahead : {0ms, 1ms, 300ms, 1000ms, 60000ms}) expect_same(visit.ahead(ahead), visit.walker());
}

TEST(Prediction, of_no_time_is_the_present_and_of_a_long_one_is_bounded) {
  Visit visit;
  visit.keys = SteeringCommand{1.0, 0.0, 0.0};
  visit.go(1s);
  const Walker before = visit.walker();
  expect_same(visit.ahead(0s), before);
  expect_same(visit.ahead(-1h), before);
  expect_same(predicted(visit.walk, TimePoint::min(), visit.settings), before);
  const Walker farthest = visit.ahead(kMaxAhead);
  expect_same(visit.ahead(2s), farthest);
  expect_same(predicted(visit.walk, TimePoint::max(), visit.settings), farthest);
  EXPECT_LE((farthest.position_m - before.position_m).norm(), 1.0 + 1e-9);
  expect_same(visit.walker(), before);
}

TEST(Prediction, never_crosses_a_cut_to_another_place) {
  Visit visit;
  visit.keys = SteeringCommand{1.0, 0.0, 1.0};
  visit.go(1s);
  visit.keys.reset();
  Site elsewhere = room();
  elsewhere.start.position_m = {3, 3};
  visit.give(SceneOpened{"elsewhere", elsewhere});
  expect_same(visit.ahead(), elsewhere.start);
  visit.step();
  expect_same(visit.ahead(), elsewhere.start);
}

TEST(Prediction, never_leaves_the_walkable_area_nor_breaks_the_limits) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> any_ms(-200, 2500);
  const WalkLimits limits;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    RandomHand hand(seed, {});
    Visit visit;
    visit.settings.guide_after = 2s;
    double moved_m = 0.0;
    for (int i = 0; i < 1500; ++i) {
      visit.now += kWalkStep;
      if (i % 2 == 0) visit.give(hand.next(33ms));
      visit.give(Tick{});
      const Duration ahead = std::chrono::milliseconds(any_ms(random));
      const Walker there = visit.ahead(ahead);
      ASSERT_TRUE(visit.walk.site.area->allows(there.position_m)) << "seed " << seed << ", step " << i;
      const double seconds = std::clamp(to_seconds(ahead), 0.0, to_seconds(kMaxAhead));
      const Vector2d way = there.position_m - visit.walker().position_m;
      ASSERT_LE(way.norm(), limits.forward_m_per_s * seconds * (1.0 + 1e-6) + 1e-9);
      ASSERT_LE(std::abs(there.heading_rad - visit.walker().heading_rad),
                limits.turn_rad_per_s * seconds * (1.0 + 1e-6) + 1e-9);
      moved_m = std::max(moved_m, way.norm());
    }
    EXPECT_GT(moved_m, 0.2) << "seed " << seed;
  }
}

TEST(Prediction, needs_a_scene) {
  const VisitWalk nowhere;
  expect_same(predicted(nowhere, TimePoint(5s), {}), Walker{});
}

TEST(CanWalk, only_where_there_is_room_and_a_speed) {
  Site site = room();
  EXPECT_TRUE(can_walk(site, {}));
  WalkLimits still;
  still.forward_m_per_s = still.sideways_m_per_s = 0.0;
  EXPECT_FALSE(can_walk(site, still));
  still.sideways_m_per_s = 0.1;
  EXPECT_TRUE(can_walk(site, still));
  site.area = area_of({{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}});
  EXPECT_FALSE(can_walk(site, {}));
  site.walking_scale = 0.01;  // A model: its metres are the visitor's centimetres.
  EXPECT_TRUE(can_walk(site, {}));
  site.area = nullptr;
  EXPECT_FALSE(can_walk(site, {}));
}

}  // namespace
}  // namespace cyclorama::tour
