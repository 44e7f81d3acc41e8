// SPDX-License-Identifier: Apache-2.0
#include "common/room/wall.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/data_sets/wall_meshes.h"

namespace cyclorama {
namespace {

constexpr double kPi = std::numbers::pi;

CylinderWall cylinder() { return {.radius_m = 3.0, .arc_rad = 2.2, .bottom_m = 0.4, .top_m = 2.9}; }
PlanesWall plane() { return {{WallRectangle::facing({{0.3, 1.6, -3.0}}, 0.1, 0.2, 4.0, 2.0)}}; }
/// Three walls of a room.
PlanesWall corner() {
  return {{WallRectangle::above({-2, 1}, {-2, -2}, 0.0, 2.5), WallRectangle::above({-2, -2}, {2, -2}, 0.0, 2.5),
           WallRectangle::above({2, -2}, {2, 1}, 0.0, 2.5)}};
}
DomeWall dome() { return {{{0.0, 1.5, 0.0}}, 4.0, kPi, 0.35 * kPi}; }

std::vector<Wall> walls() {
  return {cylinder(), plane(), corner(), dome(), *MeshWall::read(obj_of(cylinder(), 40, 5))};
}

RoomRay ray(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) { return {{from}, direction}; }
RoomRay ray_to(const Eigen::Vector3d& from, const Point<frame::Room>& to) { return {{from}, to.xyz - from}; }

const Eigen::Vector3d kEye(0.2, 1.6, 0.1);

TEST(Wall, a_ray_from_the_eye_hits_the_patch_at_which_it_is_aimed_from_the_front) {
  for (const Wall& wall : walls()) {
    const auto found = patches(wall, 500);
    ASSERT_GT(found.size(), 200u) << wall.index();
    for (const WallPatch& patch : found) {
      const auto met = hit(wall, ray_to(kEye, patch.middle));
      ASSERT_TRUE(met) << wall.index();
      EXPECT_LT((met->xyz - patch.middle.xyz).norm(), 1e-9) << wall.index();
      EXPECT_LT(patch.normal.dot(patch.middle.xyz - kEye), 0.0) << wall.index();
      EXPECT_NEAR(patch.normal.norm(), 1.0, 1e-12);
      EXPECT_TRUE(is_reached(wall, patch.middle, {kEye}));
      const auto endless = hit_extended(wall, ray_to(kEye, patch.middle));
      ASSERT_TRUE(endless);
      EXPECT_EQ(endless->xyz, met->xyz);
    }
  }
}

TEST(Wall, areas_of_patches_add_up_to_the_walls) {
  const double expected[] = {3.0 * 2.2 * 2.5, 8.0, 10.0 * 2.5, 2.0 * kPi * 16.0, 3.0 * 2.2 * 2.5};
  std::size_t i = 0;
  for (const Wall& wall : walls()) {
    for (const std::size_t about : {1u, 20u, 3000u}) {
      double area = 0.0;
      for (const WallPatch& patch : patches(wall, about)) area += patch.area_m2;
      EXPECT_NEAR(area, expected[i], 2e-4 * expected[i]) << wall.index();
    }
    ++i;
  }
}

TEST(Wall, continues_smoothly_past_its_edges) {
  for (const Wall& wall : walls()) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    int beyond = 0;
    for (int i = 0; i < 3000; ++i) {
      // Directions ahead and far to the sides.
      const Eigen::Vector3d d = Eigen::Vector3d(normal(random), 0.6 * normal(random), -1.0 - std::abs(normal(random)));
      const auto here = hit_extended(wall, ray(kEye, d));
      if (!here) continue;
      if (!hit(wall, ray(kEye, d))) ++beyond;
      const auto beside = hit_extended(wall, ray(kEye, d + 1e-7 * Eigen::Vector3d(1, 1, 0)));
      ASSERT_TRUE(beside);
      const double range = (here->xyz - kEye).norm();
      EXPECT_LT((here->xyz - beside->xyz).norm(), 1e-5 * range * range) << wall.index() << " " << d.transpose();
    }
    EXPECT_GT(beyond, 100) << wall.index();
  }
}

TEST(Wall, is_visible_from_one_side_only) {
  for (const Wall& wall : walls()) {
    EXPECT_TRUE(is_lit_from(wall, {kEye})) << wall.index();
    const Eigen::Vector3d behind(0.2, 1.6, -9.0);
    EXPECT_FALSE(is_lit_from(wall, {behind})) << wall.index();
    EXPECT_FALSE(hit(wall, ray(behind, {0, 0, -1}))) << wall.index();
  }
  const Eigen::Vector3d behind(0.2, 1.6, -9.0);
  EXPECT_FALSE(hit(Wall(plane()), ray(behind, {0, 0, 1})));
  EXPECT_FALSE(hit(Wall(corner()), ray(behind, {0, 0, 1})));
}

TEST(Wall, rays_that_are_not_finite_miss) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls()) {
    for (const RoomRay& r :
         {ray({nan, 1, 0}, {0, 0, -1}), ray(kEye, {0, nan, -1}), ray(kEye, {inf, 0, -1}), ray(kEye, {0, 0, 0})}) {
      EXPECT_FALSE(hit(wall, r)) << wall.index();
      EXPECT_FALSE(hit_extended(wall, r)) << wall.index();
    }
  }
}

TEST(PlanesWall, a_plane_is_perpendicular_to_its_pan_and_tilt) {
  const WallRectangle r = WallRectangle::facing({{0, 0, 0}}, 0.5 * kPi, 0.0, 2.0, 1.0);
  // The rectangle seen when looking to the right faces left.
  EXPECT_LT((r.normal() - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((r.right - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
  const WallRectangle ceiling = WallRectangle::facing({{0, 3, 0}}, 0.0, 0.5 * kPi, 2.0, 1.0);
  EXPECT_LT((ceiling.normal() - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST(PlanesWall, has_no_gap_in_its_corners_and_continues_above_them) {
  const PlanesWall wall = corner();
  for (double height = 0.0; height <= 2.5; height += 0.01) {
    EXPECT_TRUE(wall.hit(ray_to(kEye, {{-2.0, height, -2.0}}))) << height;
    EXPECT_TRUE(wall.hit(ray_to(kEye, {{2.0, height, -2.0}}))) << height;
  }
  const Eigen::Vector3d above(2.0, 4.0, -2.0);
  const auto met = wall.hit_extended(ray_to(kEye, {above}));
  ASSERT_TRUE(met);
  EXPECT_LT((met->xyz - above).norm(), 1e-9);
}

TEST(PlanesWall, a_pillar_hides_what_is_behind_it) {
  // A wall with a narrower one in front of it.
  const PlanesWall wall{
      {WallRectangle::above({-3, -3}, {3, -3}, 0.0, 3.0), WallRectangle::above({-0.5, -1.5}, {0.5, -1.5}, 0.0, 3.0)}};
  EXPECT_FALSE(is_reached(wall, {{0.0, 1.0, -3.0}}, {{0.0, 1.0, 1.0}}));
  EXPECT_TRUE(is_reached(wall, {{0.0, 1.0, -1.5}}, {{0.0, 1.0, 1.0}}));
  EXPECT_TRUE(is_reached(wall, {{0.0, 1.0, -3.0}}, {{-3.0, 1.0, 0.0}}));
}

TEST(DomeWall, has_an_axis_that_leans_up_and_an_edge_at_half_its_field) {
  const DomeWall wall = dome();
  const auto top = wall.hit(ray(wall.centre.xyz, wall.axis()));
  ASSERT_TRUE(top);
  EXPECT_NEAR((top->xyz - wall.centre.xyz).norm(), 4.0, 1e-12);
  EXPECT_NEAR(wall.axis().y(), std::sin(0.35 * kPi), 1e-12);
  for (double around = 0.0; around < 6.3; around += 0.1) {
    EXPECT_TRUE(wall.hit(ray_to(wall.centre.xyz, wall.point_at(0.5 * kPi - 1e-6, around))));
    EXPECT_FALSE(wall.hit(ray_to(wall.centre.xyz, wall.point_at(0.5 * kPi + 1e-6, around))));
  }
  // A ray from outside, through the open half, meets the inside.
  EXPECT_TRUE(wall.hit(ray(wall.centre.xyz - 9.0 * wall.axis(), wall.axis())));
}

TEST(SolidAngle, is_an_eighth_of_a_sphere_for_an_octant_and_has_a_sign) {
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  EXPECT_NEAR(std::abs(solid_angle(origin, x, y, z)), 0.5 * kPi, 1e-12);
  EXPECT_NEAR(solid_angle(origin, x, z, y), -solid_angle(origin, x, y, z), 1e-12);
  // Counter-clockwise as seen from the front.
  EXPECT_GT(solid_angle({0, 0, 5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}), 0.0);
}

}  // namespace
}  // namespace cyclorama
