// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/walkable/ground_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderfarm/scene/area.h"
#include "tests/data_sets/plain_rooms.h"

namespace cyclorama::walkable {
namespace {

using testing::HasSubstr;

constexpr double kRadius = 0.30;
constexpr double kCell = 0.05;
/// Polygons follow cells: the tolerance is half a cell, and three quarters of one for the simplification.
constexpr double kNear = 0.07;

Result<WalkableGround> search(const scene::Scene& scene) {
  const auto probe = RayProbe::build(scene, scene.info.start_eye);
  CHECK(probe);
  return find_walkable(*probe, scene.info, scene.bounds, {});
}

/// Options for rooms in which somebody can walk.
WalkableGround found(const scene::Scene& scene) {
  auto ground = search(scene);
  CHECK(ground);
  return *std::move(ground);
}

bool holds(const WalkableGround& ground, double x, double z) {
  for (const auto& hole : ground.holes) {
    if (scene::is_inside(hole, {x, z})) return false;
  }
  return scene::is_inside(ground.outline, {x, z});
}

/// Returns the distance from the start to the border along x, in the direction of `x_sign`.
double reach(const WalkableGround& ground, double x_sign, double z = 0.0) {
  double x = 0.0;
  while (holds(ground, x_sign * x, z) && x < 100.0) x += 0.01;
  return x;
}

TEST(GroundSearch, fills_an_empty_room_up_to_a_bodys_distance_from_its_walls) {
  const WalkableGround ground = found(plain_room(4));
  EXPECT_NEAR(ground.area_m2, 7.4 * 7.4, 7.4 * 4 * kCell);
  EXPECT_NEAR(scene::area_of(ground.outline), ground.area_m2, 0.5);
  EXPECT_TRUE(ground.holes.empty());
  EXPECT_LE(ground.outline.size(), 12u);
  EXPECT_NEAR(reach(ground, 1), 4 - kRadius, kNear);
  EXPECT_NEAR(ground.radius_m, kRadius, 1e-6);
  EXPECT_NEAR(ground.floor_m, 0.0, 1e-5);
}

TEST(GroundSearch, leaves_a_hole_around_a_pillar_and_around_a_pole_thinner_than_a_cell) {
  scene::Scene scene = plain_room(4);
  add_box(scene, {1.5f, 0, -0.5f}, {2.5f, 3, 0.5f});
  add_box(scene, {-2.01f, 0, -0.01f}, {-1.99f, 3, 0.01f});
  const WalkableGround ground = found(scene);
  ASSERT_EQ(ground.holes.size(), 2u);
  EXPECT_FALSE(holds(ground, 2, 0));
  EXPECT_FALSE(holds(ground, -2, 0));
  EXPECT_FALSE(holds(ground, -2, 0.2));
  EXPECT_TRUE(holds(ground, 2, 2));
  EXPECT_TRUE(holds(ground, 3.3, 0)) << "behind the pillar";
  EXPECT_NEAR(reach(ground, 1), 1.5 - kRadius, kNear);
  EXPECT_NEAR(reach(ground, -1), 2.0 - kRadius, kNear);
}

TEST(GroundSearch, steps_onto_a_low_step_but_not_onto_a_high_one) {
  for (const float height : {0.18f, 0.32f}) {
    scene::Scene scene = plain_room(4);
    add_box(scene, {1, 0, -4}, {4, height, 4});
    const WalkableGround ground = found(scene);
    EXPECT_EQ(holds(ground, 3, 0), height < 0.25f) << height;
    EXPECT_TRUE(holds(ground, -3, 0));
  }
}

TEST(GroundSearch, steps_over_a_door_sill_but_not_over_a_railing) {
  for (const float height : {0.1f, 0.9f}) {
    scene::Scene scene = plain_room(4);
    add_box(scene, {1, 0, -4}, {1.02f, height, 4});
    EXPECT_EQ(holds(found(scene), 3, 0), height < 0.25f) << height;
  }
}

TEST(GroundSearch, is_stopped_by_a_bar_at_chest_height_and_by_glass_one_triangle_thick) {
  scene::Scene bar = plain_room(4);
  add_box(bar, {1, 1.2f, -4}, {1.02f, 1.25f, 4});
  EXPECT_FALSE(holds(found(bar), 3, 0));
  scene::Scene pane = plain_room(4);
  add_mesh(pane, quad_mesh({1, 0, -4}, {1, 3, -4}, {1, 3, 4}, {1, 0, 4}));
  EXPECT_FALSE(holds(found(pane), 3, 0));
}

TEST(GroundSearch, walks_through_blended_surfaces) {
  scene::Scene scene = plain_room(4);
  add_mesh(scene, quad_mesh({1, 0, -4}, {1, 3, -4}, {1, 3, 4}, {1, 0, 4}));
  scene::Material shaft = matte_material({1, 1, 1});
  shaft.alpha_mode = scene::AlphaMode::kBlend;
  scene.model.materials.push_back(shaft);
  scene.model.meshes.back().material = 1;
  EXPECT_TRUE(holds(found(scene), 3, 0));
}

TEST(GroundSearch, needs_head_room) {
  for (const float height : {1.70f, 1.85f}) {
    scene::Scene scene = plain_room(4);
    add_box(scene, {1, height, -4}, {4, 3, 4});
    const WalkableGround ground = found(scene);
    EXPECT_EQ(holds(ground, 3, 0), height > 1.75f) << height;
    if (height < 1.75f) {
      EXPECT_NEAR(reach(ground, 1), 1 - kRadius, kNear);
    }
  }
}

TEST(GroundSearch, crosses_a_crack_and_stops_before_a_ditch) {
  for (const float width : {0.08f, 0.6f}) {
    scene::Scene scene = scene_of(box_mesh({-4, -1, -4}, {1, 0, 4}));
    add_box(scene, {1 + width, -1, -4}, {5, 0, 4});
    scene.info.start_eye = {0, 1.6, 0};
    scene.info.eye_height_m = 1.6;
    const WalkableGround ground = found(scene);
    EXPECT_EQ(holds(ground, 3, 0), width < 0.15f) << width;
    if (width > 0.15f) {
      EXPECT_NEAR(reach(ground, 1), 1.0, kNear + kCell) << "an edge has no wall to keep from";
    }
  }
}

TEST(GroundSearch, goes_up_a_ramp_until_the_eye_would_be_too_low_but_not_up_a_steep_one) {
  const auto ramp = [](float rise) {
    scene::Scene scene = scene_of(quad_mesh({-4, 0, -4}, {1, 0, -4}, {1, 0, 4}, {-4, 0, 4}));
    add_mesh(scene, quad_mesh({1, 0, -4}, {9, 8 * rise, -4}, {9, 8 * rise, 4}, {1, 0, 4}));
    scene.info.start_eye = {0, 1.6, 0};
    scene.info.eye_height_m = 1.6;
    return found(scene);
  };
  EXPECT_NEAR(reach(ramp(0.1f), 1), 1.0 + 0.4 / 0.1, 0.1) << "0.4 m up";
  EXPECT_NEAR(reach(ramp(-0.2f), 1), 1.0 + 0.64 / 0.2, 0.1) << "0.64 m down";
  EXPECT_LT(reach(ramp(1.5f), 1), 1.25) << "56 degrees";
}

TEST(GroundSearch, goes_round_a_spiral_as_far_as_the_height_of_the_eye_permits) {
  // One turn of a ramp between the radii 1 and 3, rising 3 m from angle 0 (+x), around a newel.
  scene::Scene scene = scene_of(box_mesh({-0.9f, -1, -0.9f}, {0.9f, 5, 0.9f}));
  constexpr int kParts = 120;
  const auto at = [](float radius, int i) {
    const double angle = 2.0 * std::numbers::pi * i / kParts;
    return Eigen::Vector3f(radius * static_cast<float>(std::cos(angle)), 3.0f * static_cast<float>(i) / kParts,
                           radius * static_cast<float>(std::sin(angle)));
  };
  for (int i = 0; i < kParts; ++i) add_mesh(scene, quad_mesh(at(1, i), at(3, i), at(3, i + 1), at(1, i + 1)));
  // The visitor stands at a quarter of the turn, at a height of 0.75 m.
  scene.info.start_eye = {0, 0.75 + 1.6, 2};
  scene.info.eye_height_m = 1.6;
  const WalkableGround ground = found(scene);
  const auto walks_at = [&](double turn) {
    const double angle = 2.0 * std::numbers::pi * turn;
    return holds(ground, 2.0 * std::cos(angle), 2.0 * std::sin(angle));
  };
  EXPECT_TRUE(walks_at(0.25 + 0.35 / 3)) << "0.35 m up";
  EXPECT_FALSE(walks_at(0.25 + 0.46 / 3));
  EXPECT_TRUE(walks_at(0.25 - 0.58 / 3)) << "0.58 m down";
  EXPECT_FALSE(walks_at(0.25 - 0.70 / 3));
  EXPECT_FALSE(walks_at(0.75)) << "overhead";
}

TEST(GroundSearch, reaches_the_next_room_through_a_door_but_not_through_a_slit) {
  for (const float width : {0.9f, 0.5f}) {
    scene::Scene scene = plain_room(4);
    add_box(scene, {1, 0, -4}, {1.2f, 3, -width / 2});
    add_box(scene, {1, 0, width / 2}, {1.2f, 3, 4});
    EXPECT_EQ(holds(found(scene), 3, 0), width > 0.6f) << width;
  }
}

TEST(GroundSearch, is_independent_of_winding_scale_and_distance_from_the_origin) {
  for (const double scale : {0.01, 1.0, 50.0}) {
    scene::Scene scene = scene_of(scene::Mesh{});
    scene.model.meshes.clear();
    scene.model.instances.clear();
    const Eigen::Affine3d T =
        Eigen::Translation3d(1e5 * scale, 0, -3e4 * scale) * Eigen::Scaling(scale) * Eigen::Scaling(-1.0, 1.0, 1.0);
    scene.bounds.setEmpty();
    add_mesh(scene, box_mesh({-4, 0, -4}, {4, 3, 4}), T);
    add_mesh(scene, box_mesh({1.5f, 0, -0.5f}, {2.5f, 3, 0.5f}), T);
    scene.info.start_eye = T * Eigen::Vector3d(0, 1.6, 0);
    scene.info.eye_height_m = 1.6 * scale;
    const WalkableGround ground = found(scene);
    EXPECT_EQ(ground.holes.size(), 1u);
    EXPECT_NEAR(ground.area_m2 / (scale * scale), 7.4 * 7.4 - 1.6 * 1.6, 1.6) << scale;
  }
}

TEST(GroundSearch, reports_what_is_wrong_with_a_start) {
  scene::Scene in_the_air = plain_room(4);
  in_the_air.info.start_eye.y() = 50;
  EXPECT_THAT(search(in_the_air).error().message(), HasSubstr("no ground within"));
  scene::Scene in_a_pillar = plain_room(4);
  add_box(in_a_pillar, {-0.02f, 0, -4}, {0.02f, 1.4f, 4});
  EXPECT_THAT(search(in_a_pillar).error().message(), HasSubstr("start"));
}

TEST(GroundSearch, keeps_a_smaller_distance_if_the_start_is_nearer_to_a_wall) {
  scene::Scene scene = plain_room(4);
  add_box(scene, {-4, 0, 0.2f}, {4, 3, 0.3f});
  const WalkableGround ground = found(scene);
  EXPECT_LT(ground.radius_m, 0.2);
  EXPECT_GT(ground.radius_m, 0.1);
}

}  // namespace
}  // namespace cyclorama::walkable
