// SPDX-License-Identifier: Apache-2.0
/// A kernel compiled for more than the scene needs renders the same picture.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "renderfarm/render/kernel.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/requirements.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

std::vector<SceneNeeds> all_needs() {
  std::vector<SceneNeeds> all;
  for (unsigned bits = 0; bits < 16; ++bits) {
    for (const SurfaceLevel surface : {SurfaceLevel::kMatte, SurfaceLevel::kGlossy, SurfaceLevel::kLayered}) {
      all.push_back({(bits & 1) != 0, (bits & 2) != 0, surface, (bits & 4) != 0, (bits & 8) != 0});
    }
  }
  return all;
}

TEST(KernelFor, has_all_needed_features) {
  for (const SceneNeeds& needs : all_needs()) EXPECT_EQ(kernel_for(needs) | needs, kernel_for(needs));
}

TEST(KernelFor, reports_the_selected_kernel) {
  std::map<ShadeStage, SceneNeeds> compiled;
  for (const SceneNeeds& needs : all_needs()) {
    const auto [known, is_new] = compiled.emplace(shade_stage_for(needs), kernel_for(needs));
    EXPECT_EQ(known->second, kernel_for(needs)) << describe(needs);
  }
  EXPECT_EQ(compiled.size(), 27u);  // Opaque: 8 plain, 8 textured, 8 normal mapped; 3 layered.
}

/// A ball on a floor.
scene::Scene ball_on_floor() {
  scene::Scene scene = scene_of(square_mesh(4.0f), {0.7f, 0.5f, 0.3f});
  add_mesh(scene, sphere_mesh(0.5f, 12), Eigen::Affine3d(Eigen::Translation3d(0.2, 0.5, -1.0)));
  return scene;
}
scene::Scene under_lamp(scene::Scene scene) {
  scene::Light lamp = point_light({0.5, 2.0, 0.3}, 3.0f);
  lamp.radius_m = 0.1;
  scene.model.lights.push_back(lamp);
  return scene;
}
scene::Scene under_sky(scene::Scene scene) {
  scene.sky = {{0.4f, 0.5f, 0.8f}, {0.3f, 0.3f, 0.3f}, {0.1f, 0.1f, 0.1f}};
  return scene;
}

RadianceImage picture(scene::Scene scene, const SceneNeeds& more) {
  auto renderer = Renderer::build(std::move(scene), 1, nullptr);
  EXPECT_TRUE(renderer.has_value());
  (*renderer)->compile_for(more);
  PanoramaView view = view_from({0, 1.2, 0.6}, 64, 32, 0.5, -1.0);
  view.quality.samples = 8;
  view.quality.bounces = 3;
  return radiance_of(**renderer, view);
}

bool same_bits(const RadianceImage& a, const RadianceImage& b) {
  return std::equal(a.data().begin(), a.data().end(), b.data().begin(), b.data().end());
}

TEST(MoreGeneralKernels, are_identical_bit_by_bit_without_textures_normal_maps_and_environment) {
  const RadianceImage own = picture(under_lamp(ball_on_floor()), {});
  EXPECT_GT(mean_of(own), 0.01);
  EXPECT_TRUE(same_bits(own, picture(under_lamp(ball_on_floor()), {.textures = true})));
  EXPECT_TRUE(same_bits(own, picture(under_lamp(ball_on_floor()), {.normal_maps = true})));
  EXPECT_TRUE(same_bits(own, picture(under_lamp(ball_on_floor()), {.environment = true})));
}

TEST(MoreGeneralKernels, are_identical_bit_by_bit_for_lights_that_are_not_there) {
  const RadianceImage own = picture(under_sky(ball_on_floor()), {});
  EXPECT_GT(mean_of(own), 0.01);
  EXPECT_TRUE(same_bits(own, picture(under_sky(ball_on_floor()), {.lights = true})));
}

/// Returns the largest difference of a value relative to the mean.
double max_difference(const RadianceImage& a, const RadianceImage& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.data().size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i])));
  }
  return largest / mean_of(a);
}

TEST(MoreGeneralKernels, render_matte_surfaces_the_same) {
  // The random numbers are the same but the arithmetic differs: rounding may move a path across an edge, and no more.
  const RadianceImage own = picture(under_sky(under_lamp(ball_on_floor())), {});
  for (const SurfaceLevel surface : {SurfaceLevel::kGlossy, SurfaceLevel::kLayered}) {
    const RadianceImage other = picture(under_sky(under_lamp(ball_on_floor())), {.surface = surface});
    EXPECT_NEAR(mean_of(other) / mean_of(own), 1.0, 1e-3);
    EXPECT_LT(max_difference(own, other), 0.5);
  }
}

TEST(MoreGeneralKernels, render_glossy_surfaces_the_same) {
  const auto glossy = [] {
    scene::Scene scene = under_sky(under_lamp(ball_on_floor()));
    scene.model.materials[0].roughness = 0.4f;
    return scene;
  };
  const RadianceImage own = picture(glossy(), {});
  const RadianceImage other = picture(glossy(), {.surface = SurfaceLevel::kLayered});
  EXPECT_NEAR(mean_of(other) / mean_of(own), 1.0, 0.02);
}

}  // namespace
}  // namespace cyclorama::render
