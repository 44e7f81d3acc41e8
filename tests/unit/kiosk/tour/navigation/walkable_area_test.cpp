// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/walkable_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace cyclorama::tour {
namespace {

using Eigen::Vector2d;
using Corners = std::vector<Vector2d>;

const Corners kSquare{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}};
const Corners kAngle{{0, 0}, {10, 0}, {10, 3}, {3, 3}, {3, 10}, {0, 10}};
/// Two chambers, joined by a passage 10 cm wide.
const Corners kDumbbell{{0, 0},  {4, 0}, {4, 1.95}, {8, 1.95}, {8, 0}, {12, 0},
                        {12, 4}, {8, 4}, {8, 2.05}, {4, 2.05}, {4, 4}, {0, 4}};

Corners star(int points) {
  Corners corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = std::numbers::pi * i / points;
    corners.push_back((i % 2 == 0 ? 8.0 : 0.7) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

Corners reversed(Corners corners) { return {corners.rbegin(), corners.rend()}; }

WalkableArea area_of(Corners corners) {
  auto area = WalkableArea::make(std::move(corners));
  CHECK(area);
  return *std::move(area);
}

/// Returns whether `p` is inside by the winding number, a method other than the one under test.
bool winds_around(const Corners& corners, const Vector2d& p) {
  double turned = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d a = corners[i] - p;
    const Vector2d b = corners[(i + 1) % corners.size()] - p;
    turned += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return std::abs(turned) > std::numbers::pi;
}

TEST(WalkableArea, does_not_change_a_step_in_the_open) {
  const WalkableArea area = area_of(kSquare);
  EXPECT_LT((area.walk({1, 1}, {0.3, -0.2}) - Vector2d(1.3, 0.8)).norm(), 1e-12);
}

TEST(WalkableArea, deflects_a_step_into_a_wall_along_the_wall) {
  const WalkableArea area = area_of(kSquare);
  const Vector2d end = area.walk({4.9, 0}, {0.5, 0.5});
  EXPECT_NEAR(end.x(), 5.0 - area.margin_m(), 1e-3);
  EXPECT_GT(end.y(), 0.4);
}

TEST(WalkableArea, moves_along_a_wall_against_which_it_is_pressed) {
  const WalkableArea area = area_of(kSquare);
  Vector2d position(0, 0);
  for (int i = 0; i < 2000; ++i) position = area.walk(position, {0.004, 0.001});
  EXPECT_NEAR(position.x(), 5.0 - area.margin_m(), 1e-3);
  EXPECT_NEAR(position.y(), 2.0, 0.05);
}

TEST(WalkableArea, stops_in_a_corner_and_can_leave_it) {
  const WalkableArea area = area_of(kSquare);
  Vector2d position(4, 4);
  for (int i = 0; i < 300; ++i) position = area.walk(position, {0.02, 0.02});
  EXPECT_LT((position - Vector2d(5, 5)).norm(), 0.05);
  for (int i = 0; i < 100; ++i) position = area.walk(position, {-0.01, -0.02});
  EXPECT_LT((position - Vector2d(4, 3)).norm(), 0.1);
}

TEST(WalkableArea, goes_round_a_convex_corner) {
  const WalkableArea area = area_of(kAngle);
  Vector2d position(2.5, 6);
  // Pressed against the inner wall, towards the other arm.
  for (int i = 0; i < 600; ++i) position = area.walk(position, {0.01, -0.01});
  EXPECT_GT(position.x(), 5.9);
  EXPECT_LT(position.y(), 3.0);
}

TEST(WalkableArea, passes_through_a_narrow_passage) {
  const WalkableArea area = area_of(kDumbbell);
  Vector2d position(1, 2);
  for (int i = 0; i < 1000; ++i) position = area.walk(position, {0.01, 0.0});
  EXPECT_GT(position.x(), 10.0);
}

TEST(WalkableArea, never_crosses_a_thin_wall_however_long_the_step) {
  // A room divided by a wall with a gap at the far end.
  const WalkableArea area =
      area_of({{0, 0}, {4.999, 0}, {4.999, 9}, {5.001, 9}, {5.001, 0}, {10, 0}, {10, 10}, {0, 10}});
  Vector2d position(1, 2);
  for (int i = 0; i < 100; ++i) position = area.walk(position, {8.0, 0.0});
  EXPECT_LT(position.x(), 5.0);
}

TEST(WalkableArea, contains_a_walk_of_100000_random_steps) {
  for (const Corners& corners : {kSquare, kAngle, kDumbbell, reversed(kDumbbell), star(5), reversed(star(9))}) {
    const WalkableArea area = area_of(corners);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi);
    std::exponential_distribution<double> length(20.0);
    Vector2d position = area.nearest_allowed({1, 1});
    double direction = 0.0;
    double walked = 0.0;
    for (int i = 0; i < 100'000; ++i) {
      if (i % 40 == 0) direction = angle(random);
      const double metres = i % 1000 == 0 ? 30.0 : length(random);
      const Vector2d next = area.walk(position, metres * Vector2d(std::cos(direction), std::sin(direction)));
      ASSERT_TRUE(area.allows(next)) << i;
      ASSERT_TRUE(winds_around(corners, next)) << i;
      ASSERT_LE((next - position).norm(), metres + 32 * 2e-3 * area.margin_m() + 1e-9) << i;
      walked += (next - position).norm();
      position = next;
    }
    EXPECT_GT(walked, 500.0);  // Never permanently stuck.
  }
}

TEST(WalkableArea, goes_round_a_pillar_and_never_through) {
  const Corners pillar{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (const Corners& hole : {pillar, reversed(pillar)}) {
    const auto area = WalkableArea::make(kSquare, {hole});
    ASSERT_TRUE(area) << area.error().message();
    EXPECT_FALSE(area->allows({0, 0}));
    EXPECT_TRUE(area->allows({1.5, 0}));
    EXPECT_FALSE(area->sees({-2, 0}, {2, 0.1}));
    EXPECT_GE((area->nearest_allowed({0.3, 0})).cwiseAbs().maxCoeff(), 1.0);
    EXPECT_EQ(area->polygons(), (std::vector<Corners>{kSquare, hole}));
    Vector2d position(-3, 0.2);
    for (int i = 0; i < 2000; ++i) {
      position = area->walk(position, {0.01, 0.004});
      ASSERT_TRUE(area->allows(position));
      ASSERT_FALSE(winds_around(hole, position));
    }
    EXPECT_GT(position.x(), 2.0) << "slid along it, and on";
  }
}

TEST(WalkableArea, refuses_invalid_holes_and_holes_that_leave_nothing) {
  EXPECT_FALSE(WalkableArea::make(kSquare, {{{0, 0}, {1, 0}}}));
  EXPECT_FALSE(WalkableArea::make(kSquare, {{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}}));
  EXPECT_FALSE(WalkableArea::make(kSquare, std::vector<Corners>(400, {{0, 0}, {1, 0}, {1, 1}})));
  EXPECT_FALSE(WalkableArea::make({}, {kSquare}));
  const auto beside = WalkableArea::make(kSquare, {{{20, 20}, {30, 20}, {30, 30}}});
  ASSERT_TRUE(beside) << "in nobody's way";
  EXPECT_FALSE(beside->allows({28, 22}));
}

TEST(WalkableArea, moves_any_start_to_a_point_inside_nearby) {
  for (const Corners& corners : {kSquare, kAngle, kDumbbell, star(5)}) {
    const WalkableArea area = area_of(corners);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(-20.0, 20.0);
    for (int i = 0; i < 2000; ++i) {
      const Vector2d start(coordinate(random), coordinate(random));
      const Vector2d position = area.nearest_allowed(start);
      ASSERT_TRUE(area.allows(position));
      if (area.allows(start)) {
        EXPECT_EQ(position, start);
      }
    }
  }
  const WalkableArea square = area_of(kSquare);
  EXPECT_LT((square.nearest_allowed({9, 2}) - Vector2d(5, 2)).norm(), 0.03);
  EXPECT_LT((square.nearest_allowed({9, 9}) - Vector2d(5, 5)).norm(), 0.05);
  EXPECT_LT((square.nearest_allowed({5, 5}) - Vector2d(5, 5)).norm(), 0.05);
}

TEST(WalkableArea, returns_a_point_inside_for_a_start_that_is_not_finite) {
  const WalkableArea area = area_of(kAngle);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vector2d& start : {Vector2d(nan, 1), Vector2d(infinity, -infinity), Vector2d(1e300, 1e300)}) {
    EXPECT_TRUE(area.allows(area.nearest_allowed(start)));
  }
  EXPECT_EQ(area.walk({1, 1}, {nan, 0}), Vector2d(1, 1));
  EXPECT_EQ(area.walk({1, 1}, {infinity, 0}), Vector2d(1, 1));
  EXPECT_FALSE(area.allows({nan, nan}));
}

TEST(WalkableArea, works_at_the_size_of_a_millimetre_and_far_from_the_origin) {
  for (const double scale : {1e-4, 1.0, 1e4}) {
    for (const Vector2d& offset : {Vector2d(0, 0), Vector2d(1e5, -1e5)}) {
      Corners corners = kAngle;
      for (Vector2d& corner : corners) corner = scale * corner + offset;
      const WalkableArea area = area_of(corners);
      Vector2d position = area.nearest_allowed(offset + scale * Vector2d(2.5, 6));
      for (int i = 0; i < 2000; ++i) {
        position = area.walk(position, scale * Vector2d(0.01, -0.01));
        ASSERT_TRUE(area.allows(position));
      }
      EXPECT_GT(position.x() - offset.x(), 6.0 * scale);
    }
  }
}

TEST(WalkableArea, refuses_areas_in_which_nobody_can_stand) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Corners> wrong{{},
                                   {{0, 0}, {1, 1}},
                                   {{0, 0}, {1, 1}, {2, 2}},
                                   {{3, 3}, {3, 3}, {3, 3}},
                                   {{0, 0}, {1, 0}, {nan, 1}},
                                   {{0, 0}, {1e300, 0}, {0, 1e300}},
                                   Corners(5000, Vector2d(0, 0))};
  for (const Corners& corners : wrong) {
    const auto area = WalkableArea::make(corners);
    ASSERT_FALSE(area);
    EXPECT_EQ(area.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(area.error().message().find("walkable area"), std::string::npos);
  }
}

TEST(WalkableArea, has_lines_of_sight_that_are_straight) {
  const WalkableArea area = area_of(kAngle);
  EXPECT_TRUE(area.sees({1, 1}, {9, 1}));
  EXPECT_FALSE(area.sees({9, 2}, {2, 9}));
}

}  // namespace
}  // namespace cyclorama::tour
