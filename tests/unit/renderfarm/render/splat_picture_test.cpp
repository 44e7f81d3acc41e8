// SPDX-License-Identifier: Apache-2.0
// Splats in pictures, with and without meshes.
#include <gtest/gtest.h>

#include "common/image/colour.h"
#include "renderfarm/render/splats/cross_splats.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

constexpr float kOrange = 0.25f;  ///< Code value of the splats' green; red is 1, blue 0.

/// One splat, as large as a wall.
scene::SplatCloud veil(double z, double opacity, bool is_linear = false) {
  scene::SplatCloud cloud;
  cloud.is_linear = is_linear;
  scene::SplatValues values;
  values.position = {0, 0, z};
  values.scale = {500.0, 500.0, 0.001};
  values.opacity = opacity;
  const std::array<std::array<float, 3>, 1> orange = {
      {{scene::coefficient_of(1.0), scene::coefficient_of(double{kOrange}), scene::coefficient_of(0.0)}}};
  EXPECT_TRUE(scene::add_splat(values, orange, &cloud));
  return cloud;
}

scene::Scene scene_of_splats(const std::vector<scene::SplatCloud>& clouds) {
  scene::Scene scene;
  scene.model.materials.emplace_back();
  scene.model.splats = clouds;
  scene.bounds = Eigen::AlignedBox3d(Eigen::Vector3d(-10, -10, -10), Eigen::Vector3d(10, 10, 10));
  scene.tone = scene::ToneCurve::kLinear;
  return scene;
}

void add_wall(scene::Scene& scene, double z, float size, const Eigen::Vector3f& emission) {
  scene::Material material = matte_material(Eigen::Vector3f::Zero());
  material.emissive = emission;
  material.double_sided = true;
  scene.model.materials.push_back(material);
  add_mesh(scene, square_mesh(size, static_cast<int>(scene.model.materials.size()) - 1),
           Eigen::Translation3d(0, 0, z) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
}

PanoramaView view_ahead() {
  PanoramaView view = view_from({0, 0, 0}, 16, 16, 0.01, -0.01);
  view.panorama.azimuth_span_rad = 0.02;
  view.quality.samples = 4;
  return view;
}

Eigen::Vector3f radiance_ahead(scene::Scene scene) {
  const auto renderer = Renderer::build(std::move(scene), 1, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  const RadianceImage image = radiance_of(**renderer, view_ahead());
  return Eigen::Map<const Eigen::Vector3f>(image.at(8, 8));
}

TEST(SplatPictures, a_scene_of_splats_alone_has_their_code_values) {
  const auto renderer = Renderer::build(scene_of_splats({veil(-2, 0.6)}), 1, nullptr);
  ASSERT_TRUE(renderer.has_value()) << renderer.error().message();
  RgbImage picture;
  (*renderer)->render(view_ahead(), whole(view_ahead()), &picture, nullptr);
  EXPECT_NEAR(picture.at(8, 8)[0], 0.6 * 255, 1.0);
  EXPECT_NEAR(picture.at(8, 8)[1], 0.6 * double{kOrange} * 255, 1.0);
  EXPECT_EQ(picture.at(8, 8)[2], 0);
}

TEST(SplatPictures, a_mesh_in_front_hides_them_and_one_behind_shines_through) {
  scene::Scene front = scene_of_splats({veil(-4, 0.9)});
  add_wall(front, -2, 50.0f, {0.2f, 0.2f, 0.2f});
  EXPECT_TRUE(radiance_ahead(std::move(front)).isApprox(Eigen::Vector3f::Constant(0.2f), 1e-4f));
  scene::Scene behind = scene_of_splats({veil(-2, 0.5)});
  add_wall(behind, -4, 50.0f, {0.2f, 0.2f, 0.2f});
  const Eigen::Vector3f seen = radiance_ahead(std::move(behind));
  EXPECT_NEAR(seen[0], 0.5f + 0.1f, 1e-3f);
  EXPECT_NEAR(seen[1], 0.5f * srgb_to_linear(kOrange) + 0.1f, 1e-3f);
  EXPECT_NEAR(seen[2], 0.1f, 1e-3f);
}

TEST(SplatPictures, a_splat_over_a_surface_of_its_colour_changes_nothing) {
  for (const float transmittance : {0.9f, 0.5f, 0.01f}) {
    const Vec3 code(0.8f, 0.4f, 0.1f);
    const Vec3 behind(srgb_to_linear(0.8f), srgb_to_linear(0.4f), srgb_to_linear(0.1f));
    const Vec3 seen =
        radiance_of_splats((1.0f - transmittance) * code, transmittance, false, false) + transmittance * behind;
    EXPECT_TRUE(seen.isApprox(behind, 1e-4f)) << seen;
  }
}

TEST(SplatPictures, linear_colours_are_shown_as_they_are) {
  const Eigen::Vector3f seen = radiance_ahead(scene_of_splats({veil(-2, 0.5, true)}));
  EXPECT_NEAR(seen[1], 0.5f * kOrange, 1e-3f);
}

TEST(SplatPictures, a_mesh_casts_its_shadow_on_them) {
  const auto lit = [](bool with_screen) {
    scene::Scene scene = scene_of_splats({veil(-4, 0.95)});
    add_wall(scene, -6, 50.0f, Eigen::Vector3f::Zero());
    scene.model.lights.push_back(point_light({0, 5, -4}, 50.0f));
    if (with_screen) add_mesh(scene, square_mesh(3.0f), Eigen::Affine3d(Eigen::Translation3d(0, 2, -4)));
    return radiance_ahead(std::move(scene));
  };
  EXPECT_GT(lit(false)[0], 0.8f) << "their own light, whatever the lamp";
  EXPECT_LT(lit(true)[0], 0.05f);
}

TEST(SplatPictures, their_depth_is_noted) {
  const auto renderer = Renderer::build(scene_of_splats({veil(-2.5, 0.9)}), 1, nullptr);
  ASSERT_TRUE(renderer.has_value()) << renderer.error().message();
  PanoramaView view = view_ahead();
  view.depth = true;
  RgbImage picture;
  InverseDepthImage depth;
  (*renderer)->render(view, whole(view), &picture, nullptr, &depth);
  EXPECT_EQ(*depth.at(2, 2), inverse_depth_of(2.5f));
}

TEST(SplatPictures, tiling_changes_no_bit) {
  const auto renderer = Renderer::build(scene_of_splats({veil(-2, 0.4), veil(-3, 0.7)}), 2, nullptr);
  ASSERT_TRUE(renderer.has_value()) << renderer.error().message();
  PanoramaView view = view_from({0, 0, 0}, 48, 32, 0.4, -0.4);
  RgbImage all;
  (*renderer)->render(view, whole(view), &all, nullptr);
  RgbImage part;
  (*renderer)->render(view, {10, 5, 20, 20}, &part, nullptr);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) EXPECT_EQ(part.at(x, y)[0], all.at(10 + x, 5 + y)[0]);
  }
}

TEST(SplatPictures, a_scene_with_nothing_is_refused) {
  EXPECT_FALSE(Renderer::build(scene_of_splats({}), 1, nullptr).has_value());
}

}  // namespace
}  // namespace cyclorama::render
