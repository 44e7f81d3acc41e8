// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "renderfarm/scene/area.h"
#include "renderfarm/scene/assemble.h"

namespace cyclorama::scene {
namespace {

using Box = Eigen::AlignedBox3d;

/// Twelve triangles that face out of the box, or into it.
Mesh box_mesh(const Box& box, bool faces_in) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3f p = box.corner(static_cast<Box::CornerType>(i)).cast<float>();
    mesh.positions.push_back({p.x(), p.y(), p.z()});
  }
  const std::array<std::array<std::uint32_t, 4>, 6> sides = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& s : sides) {
    mesh.triangles.push_back({s[0], s[faces_in ? 2 : 1], s[faces_in ? 1 : 2]});
    mesh.triangles.push_back({s[0], s[faces_in ? 3 : 2], s[faces_in ? 2 : 3]});
  }
  return mesh;
}

Model model_of(std::vector<Mesh> meshes) {
  Model model;
  model.materials.emplace_back();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    model.instances.push_back({static_cast<int>(i), Eigen::Affine3d::Identity()});
  }
  model.meshes = std::move(meshes);
  return model;
}

Box box(const Eigen::Vector3d& min, const Eigen::Vector3d& max) { return {min, max}; }

FoundSettings settings_of(const Model& model) {
  const FoundSettings found = find_settings(model, bounds_of(model), std::nullopt);
  EXPECT_GE(found.walkable.size(), 3u);
  EXPECT_TRUE(is_inside(found.walkable, {found.eye.x(), found.eye.z()}));
  EXPECT_TRUE(found.eye.allFinite());
  return found;
}

TEST(FindSettings, the_eye_is_inside_a_room_and_looks_along_it) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({100, -3, 200}, {106, 1, 220}), true)}));
  EXPECT_EQ(found.kind, SceneKind::kRoom);
  EXPECT_NEAR(found.eye.y(), -3.0 + 1.6, 0.05);
  EXPECT_NEAR(std::abs(std::cos(found.heading_rad)), 1.0, 0.1) << "the room is long along z";
  for (const Eigen::Vector2d& corner : found.walkable) {
    EXPECT_TRUE(corner.x() > 100.1 && corner.x() < 105.9 && corner.y() > 200.1 && corner.y() < 219.9);
  }
}

TEST(FindSettings, a_room_is_recognised_with_thin_walls_of_either_side_and_with_thick_ones) {
  const Mesh inner = box_mesh(box({0, 0, 0}, {8, 3, 6}), true);
  const Mesh outer = box_mesh(box({-0.3, -0.3, -0.3}, {8.3, 3.3, 6.3}), false);
  EXPECT_EQ(settings_of(model_of({inner})).kind, SceneKind::kRoom);
  EXPECT_EQ(settings_of(model_of({inner, outer})).kind, SceneKind::kRoom);
}

TEST(FindSettings, the_eye_is_never_inside_a_statue) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {4, 9, 4}), false)}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_GT(found.eye.z(), 4.0);
}

TEST(FindSettings, the_eye_is_neither_on_nor_in_the_furniture) {
  const Mesh room = box_mesh(box({0, 0, 0}, {6, 3, 6}), true);
  const Mesh block = box_mesh(box({0, 0, 0}, {3, 2.9, 6}), false);
  const FoundSettings found = settings_of(model_of({room, block}));
  EXPECT_EQ(found.kind, SceneKind::kRoom);
  EXPECT_GT(found.eye.x(), 3.2);
  for (const Eigen::Vector2d& corner : found.walkable) EXPECT_GT(corner.x(), 2.95);
}

TEST(FindSettings, open_ground_is_recognised_as_a_site) {
  Model model = model_of(
      {box_mesh(box({-20, -0.2, -20}, {20, 0, 20}), false), box_mesh(box({-15, 0, -15}, {-10, 4, -10}), false)});
  const FoundSettings found = settings_of(model);
  EXPECT_EQ(found.kind, SceneKind::kSite);
  EXPECT_NEAR(found.eye.y(), 1.6, 0.05);
}

TEST(FindSettings, the_top_of_a_large_object_is_not_a_site) {
  const FoundSettings found = settings_of(model_of({box_mesh(box({0, 0, 0}, {6, 6, 6}), false)}));
  EXPECT_EQ(found.kind, SceneKind::kObject);
  EXPECT_GT(found.eye.z(), 6.0);
  const FoundSettings plain = settings_of(model_of({box_mesh(box({0, 0, 0}, {20, 3, 20}), false)}));
  EXPECT_EQ(plain.kind, SceneKind::kSite) << "nothing rises from a plain";
}

TEST(FindSettings, an_object_of_any_size_is_seen_whole_with_room_to_walk_around_it) {
  for (const double size : {1e-4, 0.01, 0.45, 2.0}) {
    const FoundSettings found =
        settings_of(model_of({box_mesh(box({0, 0, 0}, {0.8 * size, size, 0.6 * size}), false)}));
    EXPECT_EQ(found.kind, SceneKind::kObject);
    const double distance = found.eye.z() - 0.6 * size;
    EXPECT_GT(distance, 0.0);
    EXPECT_LT((size - found.eye.y()) / distance, 0.35);
    EXPECT_GT((0.0 - found.eye.y()) / distance, -0.55);
    EXPECT_FALSE(is_inside(found.walkable, {0.4 * size, 0.3 * size})) << "in the object";
    EXPECT_TRUE(is_inside(found.walkable, {0.4 * size + (found.eye.z() - 0.3 * size), 0.3 * size})) << "beside it";
    EXPECT_GT(found.eye_height_m, 0.0);
    EXPECT_GT(found.walking_scale, 0.0);
  }
}

TEST(FindSettings, the_walkable_area_goes_round_corners_and_keeps_a_distance_from_walls) {
  // An L-shaped room of 10 x 10 m, whose quarter beyond (5, 5) is a block.
  const Mesh room = box_mesh(box({0, 0, 0}, {10, 3, 10}), true);
  const Mesh block = box_mesh(box({5, 0, 5}, {10, 3, 10}), false);
  const FoundSettings found = settings_of(model_of({room, block}));
  EXPECT_TRUE(is_inside(found.walkable, {1.0, 9.0}));
  EXPECT_TRUE(is_inside(found.walkable, {9.0, 1.0}));
  EXPECT_FALSE(is_inside(found.walkable, {7.0, 7.0}));
  EXPECT_FALSE(is_inside(found.walkable, {0.1, 5.0}));
  EXPECT_NEAR(area_of(found.walkable), 61.0, 6.0);
  EXPECT_LT(found.walkable.size(), 20u);
}

TEST(FindSettings, a_given_eye_is_kept_and_can_walk) {
  const Model model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
  for (const Eigen::Vector3d& eye :
       {Eigen::Vector3d(1, 1.2, 1), Eigen::Vector3d(0.05, 1.6, 3), Eigen::Vector3d(3, 2.9, 3),
        Eigen::Vector3d(50, 1.6, 3), Eigen::Vector3d(3, 1.6, 3)}) {
    const FoundSettings found = find_settings(model, bounds_of(model), eye);
    EXPECT_EQ(found.eye, eye);
    EXPECT_TRUE(is_inside(found.walkable, {eye.x(), eye.z()})) << eye.transpose();
    EXPECT_GT(area_of(found.walkable), 0.5);
  }
  EXPECT_NEAR(find_settings(model, bounds_of(model), Eigen::Vector3d(1, 1.2, 1)).eye_height_m, 1.2, 0.05);
}

TEST(FindSettings, degenerate_geometry_gets_a_view) {
  Mesh flat = box_mesh(box({0, 0, 0}, {1, 1, 0}), false);
  settings_of(model_of({flat}));
  Mesh point;
  point.positions.assign(3, {1.0f, 2.0f, 3.0f});
  point.triangles.push_back({0, 1, 2});
  settings_of(model_of({point}));
  Mesh huge = box_mesh(box({-1e12, -1e12, -1e12}, {1e12, 1e12, 1e12}), true);
  settings_of(model_of({huge}));
}

TEST(AddLight, gives_rooms_lamps_and_objects_a_sky) {
  Scene room;
  room.model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
  room.bounds = bounds_of(room.model);
  const FoundSettings in_room = find_settings(room.model, room.bounds, std::nullopt);
  add_light(in_room, &room);
  EXPECT_GT(room.eye_lamp.x(), 0.0f);
  ASSERT_EQ(room.model.lights.size(), 1u);
  EXPECT_TRUE(room.bounds.contains(room.model.lights[0].position));
  for (const double height : {2.2, 3.0, 12.0}) {
    Scene hall;
    hall.model = model_of({box_mesh(box({0, 0, 0}, {20, height, 20}), true)});
    hall.bounds = bounds_of(hall.model);
    add_light(find_settings(hall.model, hall.bounds, std::nullopt), &hall);
    ASSERT_EQ(hall.model.lights.size(), 1u);
    const Light& lamp = hall.model.lights[0];
    const double to_ceiling = height - lamp.position.y();
    EXPECT_GT(lamp.position.y(), 0.5) << height;
    EXPECT_LT(lamp.intensity.x() / (to_ceiling * to_ceiling), 4.5) << "burns the ceiling out at " << height << " m";
  }
  Scene object;
  object.model = model_of({box_mesh(box({0, 0, 0}, {1, 1, 1}), false)});
  object.bounds = bounds_of(object.model);
  add_light(find_settings(object.model, object.bounds, std::nullopt), &object);
  EXPECT_GT(object.sky.zenith.x(), 0.0f);
  ASSERT_EQ(object.model.lights.size(), 1u);
  EXPECT_LT(object.model.lights[0].direction.y(), 0.0) << "from above";
  EXPECT_LT(object.model.lights[0].direction.z(), 0.0) << "from before the object, where the visitor is";
}

TEST(FindExposure, gives_the_same_picture_for_a_lamp_of_any_power) {
  Scene scene;
  scene.model = model_of({box_mesh(box({0, 0, 0}, {6, 3, 6}), true)});
  scene.bounds = bounds_of(scene.model);
  const FoundSettings found = find_settings(scene.model, scene.bounds, std::nullopt);
  EXPECT_EQ(find_exposure(found, scene), 1.0) << "no lamp";
  Light lamp;
  lamp.position = {3, 2.8, 3};
  scene.model.lights.push_back(lamp);
  const double exposure = find_exposure(found, scene);
  EXPECT_GT(exposure, 0.0);
  scene.model.lights[0].intensity *= 1000.0f;
  EXPECT_NEAR(find_exposure(found, scene), exposure / 1000.0, 1e-6 * exposure);
  scene.model.lights[0].intensity.setZero();
  EXPECT_EQ(find_exposure(found, scene), 1.0);
}

}  // namespace
}  // namespace cyclorama::scene
