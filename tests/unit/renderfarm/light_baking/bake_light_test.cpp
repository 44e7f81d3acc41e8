// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light_baking/bake_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderfarm/light/light_file.h"
#include "renderfarm/light_baking/visible_triangles.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

TEST(BakeLight, fills_a_white_furnace_evenly) {
  // Walls of albedo 1/2 in a closed box with the ambient radiance 1: each bounce adds half of the one before.
  scene::Scene scene = box_scene(0.5f, 4);
  scene.ambient = Eigen::Vector3f::Ones();
  scene.bounces = 3;
  const auto renderer = built(std::move(scene));
  baked(*renderer);
  render::PanoramaView view = view_from({0.3, 0.2, -0.1}, 64, 32, 1.0, -1.0);
  view.quality.bounces = 3;
  view.quality.stored_light = true;
  const RadianceImage image = radiance_of(*renderer, view);
  const float expected = 0.5f + 0.25f + 0.125f + 0.0625f;
  EXPECT_NEAR(mean_of(image), expected, 0.004f * expected);
  for (const float value : image.data()) ASSERT_NEAR(value, expected, 0.01f * expected);
}

TEST(BakeLight, equals_path_tracing_in_a_box_with_a_lamp) {
  scene::Scene scene = box_scene(0.6f, 16);
  scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.2;
  scene.exposure = 0.5;
  const auto renderer = built(std::move(scene));
  baked(*renderer);
  const Difference found = difference(*renderer, view_from({0.3, 0.2, -0.1}, 96, 48, 1.0, -1.0), 256);
  EXPECT_LT(std::abs(found.relative_bias), 0.01);
  EXPECT_LT(found.worst_codes, 4.0);
}

TEST(BakeLight, equals_path_tracing_with_gloss_metal_and_glass) {
  for (const float roughness : {0.0f, 0.4f, 0.9f}) {
    scene::Scene scene = box_scene(0.6f, 16);
    for (int kind = 0; kind < 3; ++kind) {
      scene::Material material = matte_material({0.8f, 0.6f, 0.4f});
      material.roughness = roughness;
      if (kind == 1) material.metallic = 1.0f;
      if (kind == 2) material.transmission = 1.0f;
      scene.model.materials.push_back(material);
      scene::Mesh ball = sphere_mesh(0.5f, 16, kind + 1);
      ball.origin = {1.2 * kind - 1.0, -0.8, -1.2};
      add_mesh(scene, std::move(ball));
    }
    scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
    scene.model.lights[0].radius_m = 0.3;
    scene.exposure = 0.5;
    const auto renderer = built(std::move(scene));
    baked(*renderer);
    render::PanoramaView view = view_from({0.3, 0.2, 0.4}, 96, 48, 1.0, -1.0);
    view.quality.samples = 64;
    view.quality.bounces = 4;
    const double traced = mean_of(radiance_of(*renderer, view));
    view.quality.stored_light = true;
    EXPECT_NEAR(mean_of(radiance_of(*renderer, view)) / traced, 1.0, 0.015) << roughness;
  }
}

TEST(BakeLight, does_not_leak_through_a_thin_wall_that_stands_on_one_floor) {
  // The floor and the ceiling are two triangles each; a wall of no thickness divides a bright half from a dark one.
  scene::Scene scene = box_scene(0.5f, 1);
  scene::Mesh wall = square_mesh(4.0f);
  add_mesh(scene, std::move(wall),
           Eigen::Affine3d(Eigen::Translation3d(0.37, 0, 0) *
                           Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ())));
  scene.model.lights = {point_light({1.2, 0.5, 0.3}, 20.0f)};
  scene.model.lights[0].radius_m = 0.1;
  scene.exposure = 0.5;
  scene.info.start_eye = {-1.0, 0.2, 0.1};
  const auto renderer = built(std::move(scene));
  baked(*renderer);
  // From the dark half, where nothing may shine.
  const Difference dark = difference(*renderer, view_from({-1.0, 0.2, 0.1}, 96, 48, 1.0, -1.0), 64);
  EXPECT_LT(dark.worst_codes, 1.0);
}

TEST(BakeLight, shows_shadows_on_triangles_that_are_larger_than_them) {
  scene::Scene scene = box_scene(0.5f, 1);
  scene::Mesh ball = sphere_mesh(0.3f, 16);
  ball.origin = {0.8, -1.2, 0.2};
  add_mesh(scene, std::move(ball));
  scene.model.lights = {point_light({0.9, 1.5, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.1;
  scene.exposure = 0.5;
  scene.info.start_eye = {-0.5, 0.2, 0.1};
  const auto renderer = built(std::move(scene));
  BakeSettings settings = quick();
  settings.pixels_per_degree = 4.0;
  settings.max_parts = 128;
  settings.final_rays = 128;
  const BakedLight light = baked(*renderer, settings);
  EXPECT_GT(light.grids, 0u);
  const Difference found = difference(*renderer, view_from({-0.5, 0.2, 0.1}, 96, 48, 1.0, -1.0), 256);
  EXPECT_LT(std::abs(found.relative_bias), 0.03);
  EXPECT_LT(found.worst_codes, 4.0);
}

TEST(BakeLight, does_not_depend_on_threads) {
  const auto bytes = [](int threads) {
    scene::Scene scene = box_scene(0.6f, 3);
    scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
    const auto renderer = built(std::move(scene));
    return light::light_file_bytes(*baked(*renderer, quick(), threads).store);
  };
  EXPECT_EQ(bytes(1), bytes(3));
}

TEST(BakeLight, is_finite_at_extreme_scales_and_for_degenerate_triangles) {
  for (const double scale : {1e-3, 1.0, 1e4}) {
    scene::Scene scene = box_scene(0.6f, 16);
    for (scene::Mesh& mesh : scene.model.meshes) {
      for (auto& p : mesh.positions) {
        for (float& coordinate : p) coordinate *= static_cast<float>(scale);
      }
      mesh.triangles.push_back({0, 0, 1});
      mesh.normals[0] = {0, 0, 0};
    }
    scene.bounds = Eigen::AlignedBox3d(Eigen::Vector3d::Constant(-2.0 * scale), Eigen::Vector3d::Constant(2.0 * scale));
    scene.info.start_eye *= scale;
    scene.model.lights = {
        point_light({0.5 * scale, 1.2 * scale, 0.4 * scale}, static_cast<float>(20.0 * scale * scale))};
    const auto renderer = built(std::move(scene));
    baked(*renderer);
    render::PanoramaView view = view_from(renderer->scene().info.start_eye, 48, 24, 1.0, -1.0);
    view.quality.bounces = 4;
    view.quality.stored_light = true;
    const double stored = mean_of(radiance_of(*renderer, view));
    view.quality.stored_light = false;
    view.quality.samples = 64;
    const double traced = mean_of(radiance_of(*renderer, view));
    EXPECT_NEAR(stored / traced, 1.0, 0.05) << scale;
  }
}

TEST(BakeLight, leaves_out_the_eye_lamp_which_pictures_add_wherever_the_eye_is) {
  for (const double metallic : {0.0, 1.0}) {  // Matte surfaces end paths before shading, and wide gloss in it.
    scene::Scene scene = box_scene(0.5f, 1);
    for (scene::Material& material : scene.model.materials) {
      material.metallic = static_cast<float>(metallic);
      material.roughness = 1.0f;
    }
    scene.eye_lamp = Eigen::Vector3f(4.0f, 2.0f, 1.0f);
    const auto renderer = built(std::move(scene));
    baked(*renderer);
    const Eigen::Vector3d start = renderer->scene().info.start_eye;
    for (const double step : {0.0, 0.3}) {
      render::PanoramaView view = view_from(start + Eigen::Vector3d(step, 0, step), 48, 24, 1.0, -1.0);
      view.quality.bounces = 4;
      view.quality.stored_light = true;
      const RadianceImage stored = radiance_of(*renderer, view);
      view.quality.stored_light = false;
      view.quality.samples = 64;
      const RadianceImage traced = radiance_of(*renderer, view);
      EXPECT_NEAR(mean_of(stored) / mean_of(traced), 1.0, 0.02) << metallic << ' ' << step;
      EXPECT_GT(stored.at(24, 12)[0], 1.2f * stored.at(24, 12)[2]) << "the eye lamp is red";
    }
  }
}

TEST(BakeLight, keeps_groups_of_lamps_apart_so_that_pictures_may_dim_them) {
  scene::Scene scene = box_scene(0.6f, 16);
  scene.ambient.setConstant(0.05f);
  scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f), point_light({-0.8, 0.9, -0.5}, 20.0f),
                        point_light({0.0, -1.0, 0.9}, 5.0f)};
  for (scene::Light& lamp : scene.model.lights) lamp.radius_m = 0.2;
  scene.model.lights[0].intensity = {30.0f, 10.0f, 5.0f};
  scene.model.lights[1].intensity = {5.0f, 10.0f, 30.0f};
  scene.model.lights[0].group = 1;
  scene.model.lights[1].group = 2;
  scene.info.lamp_groups = {"evening", "morning"};
  scene.exposure = 0.5;
  const auto renderer = built(std::move(scene));
  const BakedLight light = baked(*renderer);
  ASSERT_EQ(light.store->groups.size(), 2u);
  const std::vector<std::vector<float>> levels = {{}, {0.0f, 1.0f}, {0.25f, 0.0f}, {0.0f, 0.0f}, {2.0f, 0.5f}};
  for (const std::vector<float>& level : levels) {
    render::PanoramaView view = view_from({0.3, 0.2, -0.1}, 96, 48, 1.0, -1.0);
    view.lamps = scene::levels_of(level);
    const Difference found = difference(*renderer, view, 256);
    EXPECT_LT(std::abs(found.relative_bias), 0.01) << testing::PrintToString(level);
    EXPECT_LT(found.worst_codes, 5.0) << testing::PrintToString(level);
  }
}

TEST(BakeLight, computes_nothing_for_a_group_without_light) {
  scene::Scene scene = box_scene(0.6f, 8);
  scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.2;
  scene.exposure = 0.5;
  const auto alone = built(scene);
  const BakedLight one = baked(*alone);
  scene.model.lights[0].group = 1;
  scene.info.lamp_groups = {"lamp"};
  const auto grouped = built(std::move(scene));
  const BakedLight two = baked(*grouped);
  render::PanoramaView view = view_from({0.3, 0.2, -0.1}, 96, 48, 1.0, -1.0);
  view.quality.stored_light = true;
  EXPECT_NEAR(mean_of(radiance_of(*grouped, view)), mean_of(radiance_of(*alone, view)), 0.01);
  view.lamps = scene::levels_of(std::vector<float>{0.0f});
  EXPECT_EQ(mean_of(radiance_of(*grouped, view)), 0.0);
  std::size_t lit = 0;
  for (const BakeStage& stage : two.stages) lit += stage.name == "last bounce" ? 1u : 0u;
  EXPECT_EQ(lit, 1u) << "of the lamp's group alone";
  EXPECT_EQ(two.grids, one.grids);
}

TEST(BakeLight, leaves_nothing_behind_when_it_is_cancelled) {
  const auto renderer = built(box_scene(0.5f, 2));
  int calls = 0;
  const auto result = bake_light(*renderer, quick(), 1, nullptr, [&] { return ++calls > 3; });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(renderer->light(), nullptr);
}

TEST(VisibleTriangles, are_those_on_the_eyes_side_alone) {
  const auto renderer = built(box_scene(0.5f, 2));
  const VisibleTriangles visible = find_visible_triangles(*renderer, quick(), nullptr);
  EXPECT_EQ(visible.seen, 6u * 8u);
  for (const auto& sides : visible.places) {
    EXPECT_TRUE(sides[1].empty());
    for (const SeenPlace& place : sides[0]) {
      EXPECT_LT(place.distance, 4.0f);
      EXPECT_NEAR(place.weights().sum(), 1.0f, 1e-4f);
      EXPECT_GE(place.weights().minCoeff(), 0.0f);
    }
  }
}

TEST(WalkableEyes, stay_in_the_walkable_area) {
  scene::SceneInfo info;
  info.start_eye = {0.5, 1.6, 0.5};
  info.walkable = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  info.walkable_holes = {{{1, 1}, {3, 1}, {3, 3}, {1, 3}}};
  const std::vector<Eigen::Vector3d> eyes = walkable_eyes(info, 100, 1);
  ASSERT_EQ(eyes.size(), 100u);
  for (const Eigen::Vector3d& eye : eyes) {
    const bool in_hole = eye.x() > 1 && eye.x() < 3 && eye.z() > 1 && eye.z() < 3;
    EXPECT_FALSE(in_hole);
    EXPECT_NEAR(eye.y(), 1.6, 0.25);
  }
}

}  // namespace
}  // namespace cyclorama::light_baking
