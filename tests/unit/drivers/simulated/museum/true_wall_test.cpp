// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/true_wall.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cyclorama::simulated {
namespace {

const RigidTransform<frame::Room, frame::Room> kStays;
const CylinderWall kCylinder{4.3, 2.2, 0.5, 2.7};
const DomeWall kDome{{Eigen::Vector3d(0.0, 1.6, 0.0)}, 4.0, 1.6, 0.4};

WallDeviation some_deviation() {
  WallDeviation deviation;
  deviation.waves = {{0.02, 1.5, 0.7, 0.3}, {0.01, -3.0, 1.0, 1.0}};
  deviation.bumps = {{0.03, 0.5, 0.2, 0.3}, {-0.02, -1.0, -0.3, 0.5}};
  return deviation;
}

std::vector<TrueWall> walls_with(const WallDeviation& deviation) {
  const PlanesWall plane{{WallRectangle::facing({Eigen::Vector3d(0.0, 1.6, -4.0)}, 0.2, 0.1, 6.0, 2.4)}};
  return {*TrueWall::make(kCylinder, kStays, deviation), *TrueWall::make(plane, kStays, deviation),
          *TrueWall::make(kDome, kStays, deviation)};
}

TEST(TrueWall, without_deviation_agrees_with_the_installations_wall) {
  for (const Wall& shape : {Wall(kCylinder), Wall(kDome)}) {
    const TrueWall wall = *TrueWall::make(shape, kStays, {});
    for (double across = -1.0; across <= 1.0; across += 0.13) {
      const RoomRay ray{{Eigen::Vector3d(0.2, 1.5, 0.3)}, Eigen::Vector3d(across, 0.1, -1.0)};
      const auto expected = hit(shape, ray);
      const auto got = wall.hit(ray);
      ASSERT_EQ(expected.has_value(), got.has_value());
      if (got) {
        EXPECT_LT((expected->xyz - got->point.xyz).norm(), 1e-12);
      }
    }
  }
}

// A ray must meet the surface at the position given by the surface's own coordinates.
TEST(TrueWall, a_ray_to_a_point_of_the_wall_hits_it) {
  const Eigen::Vector3d eye(0.3, 1.5, 0.2);
  for (const WallDeviation& deviation : {WallDeviation(), some_deviation()}) {
    for (const TrueWall& wall : walls_with(deviation)) {
      for (double across = 0.03; across < 1.0; across += 0.09) {
        for (double along = 0.03; along < 1.0; along += 0.11) {
          const TrueWall::Hit at = wall.at({0, across, along});
          const auto met = wall.hit({{eye}, at.point.xyz - eye});
          ASSERT_TRUE(met);
          EXPECT_LT((met->point.xyz - at.point.xyz).norm(), 1e-9);
          EXPECT_NEAR(met->position.across, across, 1e-9);
          EXPECT_NEAR(met->position.along, along, 1e-9);
          EXPECT_LT((met->normal - at.normal).norm(), 1e-6);
        }
      }
    }
  }
}

TEST(TrueWall, its_normal_agrees_with_three_nearby_points) {
  for (const TrueWall& wall : walls_with(some_deviation())) {
    constexpr double kStep = 1e-5;
    const Eigen::Vector3d eye(0.0, 1.6, 0.0);
    for (double across = 0.1; across < 1.0; across += 0.17) {
      const auto at = [&](double a, double b) { return wall.at({0, across + a, 0.4 + b}).point.xyz; };
      Eigen::Vector3d normal = (at(kStep, 0) - at(-kStep, 0)).cross(at(0, kStep) - at(0, -kStep)).normalized();
      if (normal.dot(eye - at(0, 0)) < 0.0) normal = -normal;
      EXPECT_LT((wall.at({0, across, 0.4}).normal - normal).norm(), 1e-4);
    }
  }
}

TEST(TrueWall, a_grazing_ray_hits_the_first_of_several_bumps) {
  WallDeviation deviation;
  deviation.bumps = {{0.2, -1.0, 0.0, 0.15}};
  const PlanesWall plane{{WallRectangle::facing({Eigen::Vector3d(0.0, 1.6, -4.0)}, 0.0, 0.0, 6.0, 2.4)}};
  const TrueWall wall = *TrueWall::make(plane, kStays, deviation);
  const Eigen::Vector3d origin(-2.9, 1.6, -3.85);
  const auto met = wall.hit({{origin}, Eigen::Vector3d(1.0, 0.0, -0.04)});
  ASSERT_TRUE(met);
  EXPECT_LT(met->point.xyz.x(), -1.0);  // On the near side of the bump.
  EXPECT_NEAR(met->point.xyz.z(), -4.0 + deviation.at(met->point.xyz.x(), 0.0).m, 1e-6);
}

TEST(TrueWall, moves_rigidly) {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.05, Eigen::Vector3d(1.0, 0.2, 0.3).normalized()));
  const RigidTransform<frame::Room, frame::Room> moved(turned, {0.1, -0.05, 0.02});
  const TrueWall there = *TrueWall::make(kCylinder, moved, some_deviation());
  const TrueWall here = *TrueWall::make(kCylinder, kStays, some_deviation());
  const RoomRay ray{{Eigen::Vector3d(0.2, 1.5, 0.3)}, Eigen::Vector3d(0.4, 0.05, -1.0)};
  const RoomRay moved_ray{moved * ray.origin, moved.rotation() * ray.direction};
  const auto a = here.hit(ray);
  const auto b = there.hit(moved_ray);
  ASSERT_TRUE(a && b);
  EXPECT_LT(((moved * a->point).xyz - b->point.xyz).norm(), 1e-9);
}

TEST(TrueWall, has_the_area_of_its_shape) {
  const double whole = TrueWall::make(kDome, kStays, {})->area_m2({0, 0, 0}, {0, 1, 1});
  EXPECT_NEAR(whole, 2.0 * std::numbers::pi * 16.0 * (1.0 - std::cos(0.8)), 1e-9);
  EXPECT_NEAR(TrueWall::make(kCylinder, kStays, {})->area_m2({0, 0, 0}, {0, 1, 1}), 4.3 * 2.2 * 2.2, 1e-9);
}

TEST(TrueWall, refuses_an_impossible_shape) {
  const PlanesWall corner{{WallRectangle::above({-3, 0}, {0, -3}, 0, 2), WallRectangle::above({0, -3}, {3, 0}, 0, 2)}};
  EXPECT_TRUE(TrueWall::make(corner, kStays, {}));
  EXPECT_FALSE(TrueWall::make(corner, kStays, some_deviation()));
  EXPECT_FALSE(TrueWall::make(PlanesWall{}, kStays, {}));
  EXPECT_FALSE(TrueWall::make(*MeshWall::read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), kStays, {}));
}

}  // namespace
}  // namespace cyclorama::simulated
