// SPDX-License-Identifier: Apache-2.0
// Scenes at the limits: tiny and huge ones, far from the origin, with many lamps, with broken geometry, with instances.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderfarm/light/light_store.h"
#include "renderfarm/light/rgb9e5.h"
#include "tests/unit/renderfarm/light_baking/light_cases.h"

namespace cyclorama::light_baking {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Returns the light of a picture with stored light over that of a path traced one, both finite in every pixel.
double stored_over_traced(const render::Renderer& renderer) {
  render::PanoramaView view = view_from(renderer.scene().info.start_eye, 48, 24, 1.0, -1.0);
  view.quality.bounces = renderer.scene().bounces;
  view.quality.samples = 64;
  const RadianceImage traced = radiance_of(renderer, view);
  view.quality.stored_light = true;
  const RadianceImage stored = radiance_of(renderer, view);
  for (const RadianceImage* const image : {&traced, &stored}) {
    EXPECT_TRUE(std::ranges::all_of(image->data(), [](float value) { return std::isfinite(value) && value >= 0.0f; }));
  }
  return mean_of(stored) / mean_of(traced);
}

/// Scales a scene about a point, and moves that point to `origin`.
void transform(double scale, const Eigen::Vector3d& origin, scene::Scene* scene) {
  for (scene::Mesh& mesh : scene->model.meshes) {
    for (auto& position : mesh.positions) {
      for (float& coordinate : position) coordinate *= static_cast<float>(scale);
    }
    mesh.origin = Eigen::Vector3d(scale * mesh.origin + origin);
  }
  for (scene::Light& lamp : scene->model.lights) {
    lamp.position = scale * lamp.position + origin;
    lamp.radius_m *= scale;
    lamp.intensity *= static_cast<float>(scale * scale);
  }
  scene->bounds = Eigen::AlignedBox3d(origin - Eigen::Vector3d::Constant(2.0 * scale),
                                      origin + Eigen::Vector3d::Constant(2.0 * scale));
  scene->info.start_eye = scale * scene->info.start_eye + origin;
}

scene::Scene lit_box(int parts) {
  scene::Scene scene = box_scene(0.6f, parts);
  scene.model.lights = {point_light({0.5, 1.2, 0.4}, 20.0f)};
  scene.model.lights[0].radius_m = 0.2;
  scene.bounces = 3;
  return scene;
}

TEST(LightExtremes, scenes_of_one_millimetre_and_of_100_kilometres_have_their_light) {
  for (const double scale : {2.5e-4, 2.5e4}) {
    scene::Scene scene = lit_box(12);
    transform(scale, Eigen::Vector3d::Zero(), &scene);
    const auto renderer = built(std::move(scene));
    baked(*renderer);
    EXPECT_NEAR(stored_over_traced(*renderer), 1.0, 0.03) << scale;
  }
}

TEST(LightExtremes, a_scene_far_from_the_origin_has_its_light) {
  for (const double distance : {0.0, 1e4, 5e6}) {
    scene::Scene scene = lit_box(12);
    transform(1.0, {distance, -0.5 * distance, 0.25 * distance}, &scene);
    const auto renderer = built(std::move(scene));
    baked(*renderer);
    EXPECT_NEAR(stored_over_traced(*renderer), 1.0, 0.03) << distance;
  }
}

TEST(LightExtremes, ten_thousand_lamps_light_a_scene_as_in_traced_pictures) {
  scene::Scene scene = box_scene(0.6f, 8);
  constexpr int kEach = 100;
  for (int i = 0; i < kEach * kEach; ++i) {
    const int column = i % kEach;
    const int row = i / kEach;
    const double x = 3.6 * (column + 0.5) / kEach - 1.8;
    const double z = 3.6 * (row + 0.5) / kEach - 1.8;
    scene.model.lights.push_back(point_light({x, 1.7, z}, 20.0f / (kEach * kEach)));
  }
  scene.bounces = 3;
  const auto renderer = built(std::move(scene));
  baked(*renderer);
  EXPECT_NEAR(stored_over_traced(*renderer), 1.0, 0.03);
}

TEST(LightExtremes, broken_normals_and_degenerate_triangles_leave_all_other_light_as_it_is) {
  scene::Scene scene = lit_box(12);
  for (scene::Mesh& mesh : scene.model.meshes) {
    mesh.normals[0] = {kNan, kNan, kNan};
    mesh.normals[5] = {0.0f, 0.0f, 0.0f};
    mesh.normals[9] = {std::numeric_limits<float>::infinity(), 0.0f, 0.0f};
    mesh.triangles.push_back({0, 0, 1});
    mesh.triangles.push_back({2, 2, 2});
  }
  const auto renderer = built(std::move(scene));
  const BakedLight light = baked(*renderer);
  for (const light::SurfaceLight& surface : light.store->surfaces) {
    for (const light::SideLight& side : surface.sides) {
      for (const std::uint32_t sample : side.base) {
        if (sample == light::kNoSample) continue;
        EXPECT_TRUE(light::from_rgb9e5(sample).allFinite());
      }
    }
  }
  EXPECT_TRUE(std::isfinite(light.store->unit));
  EXPECT_NEAR(stored_over_traced(*renderer), 1.0, 0.05);
}

TEST(LightExtremes, a_thousand_instances_of_a_mesh_have_light_of_their_own_in_bounded_memory) {
  scene::Scene scene = lit_box(8);
  constexpr int kEach = 10;
  add_mesh(scene, sphere_mesh(0.05f, 8));
  const scene::Instance first = scene.model.instances.back();
  for (int i = 1; i < kEach * kEach * kEach; ++i) {
    scene::Instance instance = first;
    const int row = i / kEach;
    const int layer = row / kEach;
    instance.T_model_mesh =
        Eigen::Translation3d(0.36 * (i % kEach) - 1.7, 0.36 * (row % kEach) - 1.9, 0.36 * layer - 1.7) *
        first.T_model_mesh;
    scene.model.instances.push_back(instance);
  }
  const std::size_t instances = scene.model.instances.size();
  const auto renderer = built(std::move(scene));
  BakeSettings settings = quick();
  settings.min_bytes = 0;
  const BakedLight light = baked(*renderer, settings);
  EXPECT_EQ(light.store->surfaces.size(), instances);
  // Both sides of every vertex; grids get what is left of 12 bytes a triangle.
  const double per_triangle =
      static_cast<double>(light.store->bytes()) / static_cast<double>(renderer->scene().triangles_seen());
  EXPECT_LT(per_triangle, 12.0);
  EXPECT_NEAR(stored_over_traced(*renderer), 1.0, 0.03);
}

}  // namespace
}  // namespace cyclorama::light_baking
