// SPDX-License-Identifier: Apache-2.0
/// A kernel for more than the scene needs renders the same picture.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "renderfarm/render/kernel.h"
#include "renderfarm/render/renderer.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

TEST(ShadeStage, exists_once_for_each_surface_level) {
  std::set<ShadeStage> stages;
  for (const SurfaceLevel level : {SurfaceLevel::kMatte, SurfaceLevel::kGlossy, SurfaceLevel::kLayered}) {
    stages.insert(shade_stage_for(level));
  }
  EXPECT_EQ(stages.size(), 3u);
}

/// A ball on a floor.
scene::Scene ball_on_floor() {
  scene::Scene scene = scene_of(square_mesh(4.0f), {0.7f, 0.5f, 0.3f});
  add_mesh(scene, sphere_mesh(0.5f, 12), Eigen::Affine3d(Eigen::Translation3d(0.2, 0.5, -1.0)));
  scene::Light lamp = point_light({0.5, 2.0, 0.3}, 3.0f);
  lamp.radius_m = 0.1;
  scene.model.lights.push_back(lamp);
  scene.sky = {{0.4f, 0.5f, 0.8f}, {0.3f, 0.3f, 0.3f}, {0.1f, 0.1f, 0.1f}};
  return scene;
}

RadianceImage picture(scene::Scene scene, SurfaceLevel at_least) {
  auto renderer = Renderer::build(std::move(scene), 1, nullptr);
  EXPECT_TRUE(renderer.has_value());
  (*renderer)->use_kernel_for(at_least);
  PanoramaView view = view_from({0, 1.2, 0.6}, 64, 32, 0.5, -1.0);
  view.quality.samples = 8;
  view.quality.bounces = 3;
  return radiance_of(**renderer, view);
}

bool same_bits(const RadianceImage& a, const RadianceImage& b) {
  return std::equal(a.data().begin(), a.data().end(), b.data().begin(), b.data().end());
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
  const RadianceImage own = picture(ball_on_floor(), SurfaceLevel::kMatte);
  EXPECT_GT(mean_of(own), 0.01);
  for (const SurfaceLevel level : {SurfaceLevel::kGlossy, SurfaceLevel::kLayered}) {
    const RadianceImage other = picture(ball_on_floor(), level);
    EXPECT_NEAR(mean_of(other) / mean_of(own), 1.0, 1e-3);
    EXPECT_LT(max_difference(own, other), 0.5);
  }
}

scene::Scene glossy_ball() {
  scene::Scene scene = ball_on_floor();
  scene.model.materials[0].roughness = 0.4f;
  return scene;
}

TEST(MoreGeneralKernels, render_glossy_surfaces_the_same) {
  const RadianceImage own = picture(glossy_ball(), SurfaceLevel::kMatte);
  const RadianceImage other = picture(glossy_ball(), SurfaceLevel::kLayered);
  EXPECT_NEAR(mean_of(other) / mean_of(own), 1.0, 0.02);
}

TEST(SimplerKernels, are_never_selected) {
  const RadianceImage own = picture(glossy_ball(), SurfaceLevel::kGlossy);
  EXPECT_TRUE(same_bits(own, picture(glossy_ball(), SurfaceLevel::kMatte)));
}

}  // namespace
}  // namespace cyclorama::render
