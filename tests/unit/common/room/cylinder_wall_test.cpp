// SPDX-License-Identifier: Apache-2.0
#include "common/room/cylinder_wall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace cyclorama {
namespace {

constexpr double kPi = std::numbers::pi;

CylinderWall half_circle() {
  return {.radius_m = 3.0, .arc_rad = kPi, .bottom_m = 0.2, .top_m = 2.8, .centre_x_m = 0.5, .centre_z_m = -0.25};
}

RoomRay ray(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) { return {{from}, direction}; }

TEST(CylinderWall, points_and_arc_angles_are_inverse) {
  const CylinderWall wall = half_circle();
  for (double angle = -1.5; angle <= 1.5; angle += 0.1) {
    EXPECT_NEAR(wall.arc_angle_of(wall.point_at(angle, 1.0)), angle, 1e-12);
  }
  EXPECT_LT((wall.point_at(0.0, 1.0).xyz - Eigen::Vector3d(0.5, 1.0, -3.25)).norm(), 1e-12);
  EXPECT_LT((wall.point_at(0.5 * kPi, 1.0).xyz - Eigen::Vector3d(3.5, 1.0, -0.25)).norm(), 1e-12);
}

TEST(CylinderWall, a_ray_from_inside_hits_the_point_at_which_it_is_aimed) {
  const CylinderWall wall = half_circle();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double angle = (unit(random) - 0.5) * kPi * 0.99;
    const Eigen::Vector3d target = wall.point_at(angle, 0.21 + 2.58 * unit(random)).xyz;
    const double r = 2.9 * std::sqrt(unit(random));
    const double a = 2.0 * kPi * unit(random);
    const Eigen::Vector3d from(0.5 + r * std::sin(a), 3.0 * unit(random), -0.25 + r * std::cos(a));
    const auto hit = wall.hit(ray(from, (0.01 + unit(random)) * (target - from)));
    ASSERT_TRUE(hit.has_value());
    EXPECT_LT((hit->xyz - target).norm(), 1e-9);
  }
}

TEST(CylinderWall, rays_past_its_edges_miss) {
  const CylinderWall wall = half_circle();
  const Eigen::Vector3d eye(0.5, 1.6, -0.25);
  EXPECT_FALSE(wall.hit(ray(eye, {0, 0, 1})).has_value());        // Behind: the arc is half a circle.
  EXPECT_FALSE(wall.hit(ray(eye, {0, 1, -1})).has_value());       // Above.
  EXPECT_FALSE(wall.hit(ray(eye, {0, -1, -1})).has_value());      // Below.
  EXPECT_FALSE(wall.hit(ray(eye, {0, 1, 0})).has_value());        // Along the axis.
  EXPECT_FALSE(wall.hit(ray({9, 1, 0}, {1, 0, 0})).has_value());  // Away from it.
}

TEST(CylinderWall, its_outside_cannot_be_hit) {
  const CylinderWall wall = half_circle();
  EXPECT_FALSE(wall.hit(ray({0.5, 1.0, -9.0}, {0, 0, -1})).has_value());
  // From the front, through the open side, and from the back, through the wall: both rays meet the inside of the far
  // part.
  EXPECT_TRUE(wall.hit(ray({0.5, 1.0, 9.0}, {0, 0, -1})).has_value());
  CylinderWall round = wall;
  round.arc_rad = 2.0 * kPi;
  const auto far_side = round.hit(ray({0.5, 1.0, -9.0}, {0, 0, 1}));
  ASSERT_TRUE(far_side.has_value());
  EXPECT_NEAR(far_side->xyz.z(), 2.75, 1e-9);
}

TEST(CylinderWall, rays_that_are_not_finite_miss) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const CylinderWall wall = half_circle();
  EXPECT_FALSE(wall.hit(ray({nan, 1, 0}, {0, 0, -1})).has_value());
  EXPECT_FALSE(wall.hit(ray({0.5, 1, 0}, {0, nan, -1})).has_value());
  EXPECT_FALSE(wall.hit(ray({0.5, 1, 0}, {inf, 0, -1})).has_value());
  EXPECT_FALSE(wall.hit(ray({0.5, 1, 0}, {0, 0, 0})).has_value());
}

}  // namespace
}  // namespace cyclorama
