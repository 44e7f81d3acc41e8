// SPDX-License-Identifier: Apache-2.0
/// The whole path tracer against known results: series, furnaces and invariances.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "renderfarm/render/vectors.h"
#include "tests/data_sets/mixed_room.h"
#include "tests/support/measured_light.h"

namespace cyclorama::render {
namespace {

constexpr double kFurnaceTolerance = 0.025;

/// A closed hollow ball that emits and reflects.
scene::Scene glowing_furnace(float albedo, float radiance, bool double_sided) {
  scene::Scene scene = scene_of(sphere_mesh(2.0f, 16), Eigen::Vector3f::Constant(albedo));
  scene.model.materials[0].emissive.setConstant(radiance);
  scene.model.materials[0].double_sided = double_sided;
  return scene;
}

PanoramaView view_around(int bounces, int samples) {
  PanoramaView view = view_from({0.3, 0.2, 0.1}, 16, 16, 1.0, -1.0);
  view.quality.bounces = bounces;
  view.quality.samples = samples;
  return view;
}

scene::Sky even_sky() { return {Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones()}; }

/// Returns 1 + albedo + ... + albedo^max.
double series(double albedo, int max) { return (1.0 - std::pow(albedo, max + 1)) / (1.0 - albedo); }

TEST(PathTracer, a_furnace_that_glows_inside_gives_a_geometric_series) {
  constexpr double kGlow = 0.5;
  for (const float albedo : {0.2f, 0.5f, 0.8f}) {
    const auto renderer = built(glowing_furnace(albedo, static_cast<float>(kGlow), true));
    for (const int bounces : {0, 1, 3, 8}) {
      SCOPED_TRACE(testing::Message() << "albedo " << albedo << ", bounces " << bounces);
      // Emission, then light reflected once for no bounces, and once more for each bounce.
      const double expected = kGlow * series(static_cast<double>(albedo), bounces + 1);
      const MeasuredLight light = measured(*renderer, view_around(bounces, 4), 8);
      EXPECT_NEAR(light.mean / expected, 1.0, kFurnaceTolerance);
      EXPECT_LT(light.error / expected, 0.2 * kFurnaceTolerance);
    }
  }
}

/// The front is outside, so light sampling ignores the inside: every reflection must be found by BSDF sampling.
TEST(PathTracer, a_furnace_that_glows_outside_lacks_the_light_sample_of_the_last_bounce) {
  for (const int bounces : {1, 5}) {
    const double expected = series(0.5, bounces);
    const MeasuredLight light = measured(*built(glowing_furnace(0.5f, 1.0f, false)), view_around(bounces, 4), 8);
    EXPECT_NEAR(light.mean / expected, 1.0, kFurnaceTolerance);
  }
}

/// Russian roulette ends paths of many bounces; the surviving paths account for them.
TEST(PathTracer, russian_roulette_keeps_the_series) {
  for (const float albedo : {0.3f, 0.6f, 0.9f}) {
    const auto renderer = built(glowing_furnace(albedo, 1.0f, true));
    const double expected = series(static_cast<double>(albedo), kMaxBounces + 1);
    const MeasuredLight light = measured(*renderer, view_around(kMaxBounces, 4), 16);
    EXPECT_NEAR(light.mean / expected, 1.0, kFurnaceTolerance) << albedo;
    expect_light(light, expected);
  }
}

struct NamedMaterial {
  std::string name;
  scene::Material material;
};

std::vector<NamedMaterial> white_materials() {
  std::vector<NamedMaterial> all = {{"matte", matte_material(Eigen::Vector3f::Ones())}};
  for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    const std::string rough = " of roughness " + std::to_string(roughness).substr(0, 3);
    all.push_back({"plastic" + rough, white_material(roughness, 0.0f)});
    all.push_back({"metal" + rough, white_material(roughness, 1.0f)});
    scene::Material coated = white_material(roughness, 0.5f);
    coated.clearcoat = 1.0f;
    coated.clearcoat_roughness = 0.2f;
    all.push_back({"coated" + rough, coated});
    scene::Material glass = white_material(roughness, 0.0f);
    glass.transmission = 1.0f;
    all.push_back({"thin glass" + rough, glass});
    glass.thickness = 1.0f;
    // Rough diamonds keep light for more bounces than are allowed.
    for (const float ior : {1.0f, 1.33f, 1.5f}) {
      glass.ior = ior;
      all.push_back({"glass of ior " + std::to_string(ior).substr(0, 3) + rough, glass});
    }
  }
  return all;
}

TEST(PathTracer, white_balls_of_every_material_are_invisible_in_even_light) {
  for (const NamedMaterial& at : white_materials()) {
    SCOPED_TRACE(at.name);
    scene::Scene scene = scene_of(sphere_mesh(1.0f, 16));
    scene.model.materials[0] = at.material;
    scene.sky = even_sky();
    PanoramaView view = view_from({0, 0, 2.5}, 16, 16, 0.3, -0.3);
    view.panorama.azimuth_span_rad = 0.6;
    view.quality.samples = 8;
    view.quality.bounces = kMaxBounces;
    const MeasuredLight light = measured(*built(std::move(scene)), view, 4);
    EXPECT_NEAR(light.mean, 1.0, kFurnaceTolerance) << "error " << light.error;
  }
}

TEST(PathTracer, is_linear_in_the_lamps_power) {
  const PanoramaView view = room_view(4, 8);
  const Film film = film_of(*built(mixed_room()), view);
  for (const float scale : {0x1p-20f, 0x1p20f, 1e-6f, 1e6f}) {
    const bool exact = scale == 0x1p-20f || scale == 0x1p20f;
    const Film scaled = film_of(*built(mixed_room(scale)), view);
    for (std::size_t i = 0; i < film.sum.data().size(); ++i) {
      const float expected = film.sum.data()[i] * scale;
      ASSERT_NEAR(scaled.sum.data()[i], expected, exact ? 0.0f : 1e-5f * expected) << scale << ", value " << i;
    }
  }
}

TEST(PathTracer, more_light_samples_do_not_change_the_mean) {
  const auto renderer = built(mixed_room());
  PanoramaView view = room_view(2, 8);
  const MeasuredLight one = measured(*renderer, view, 16);
  for (const int light_samples : {3, 4, 16}) {
    SCOPED_TRACE(light_samples);
    view.quality.light_samples = light_samples;
    view.quality.samples = 4;
    expect_same_light(measured(*renderer, view, 16), one);
  }
}

TEST(PathTracer, more_bounces_are_never_darker) {
  const auto renderer = built(mixed_room());
  MeasuredLight before;
  for (const int bounces : {0, 1, 2, 4, 8, 16}) {
    const MeasuredLight light = measured(*renderer, room_view(bounces, 8), 16);
    EXPECT_GT(light.mean, before.mean - kMaxErrors * std::hypot(light.error, before.error)) << bounces;
    before = light;
  }
}

TEST(PathTracer, the_firefly_limit_reports_the_light_that_it_removed) {
  const auto renderer = built(mixed_room());
  PanoramaView view = room_view(6, 16);
  const auto light = [&](double* ret_removed) {
    Film film;
    *ret_removed = renderer->render_film(view, whole(view), false, &film, nullptr).removed_light;
    double sum = 0.0;
    for (std::size_t i = 0; i < film.samples.data().size(); ++i) {
      const float* const rgb = &film.sum.data()[3 * i];
      sum += static_cast<double>(luminance(Vec3(rgb[0], rgb[1], rgb[2])));
    }
    return sum;
  };
  double removed = 0.0;
  const double all = light(&removed);
  EXPECT_EQ(removed, 0.0);
  double min = 0.0;
  for (const float limit : {1.0f, 0.3f, 0.1f}) {
    view.quality.firefly_limit = limit;
    const double left = light(&removed);
    EXPECT_GT(removed, min);
    EXPECT_NEAR(left / (1.0 - removed), all, 1e-4 * all) << limit;
    min = removed;
  }
}

scene::Light overhead_lamp() {
  scene::Light light;
  light.kind = scene::LightKind::kRectangle;
  light.position = {0.1, 2.0, -0.3};
  light.size_m = {0.8, 0.8};
  light.intensity.setConstant(5.0f);
  light.visible = true;
  return light;
}

/// Only scattered rays find a lamp behind glass, because shadow rays end at the pane.
TEST(PathTracer, light_comes_through_clear_panes) {
  for (const bool body : {false, true}) {
    scene::Scene scene = scene_of(square_mesh(0.01f));
    scene.model.lights = {overhead_lamp()};
    PanoramaView view = view_of_one_point();
    view.quality.bounces = 1;
    view.quality.samples = 32;
    const MeasuredLight open = measured(*built(scene), view);
    scene::Material glass = white_material(0.0f, 0.0f);
    glass.transmission = 1.0f;
    glass.thickness = body ? 0.1f : 0.0f;
    scene.model.materials.push_back(glass);
    const auto above = [](double height) { return Eigen::Affine3d(Eigen::Translation3d(0, height, -3.0)); };
    // The eye is not behind the pane.
    add_mesh(scene, square_mesh(7.0f, 1), above(1.5));
    if (body) {
      scene::Mesh under = square_mesh(7.0f, 1);
      for (auto& t : under.triangles) std::swap(t[1], t[2]);
      add_mesh(scene, std::move(under), above(1.499));
    }
    const MeasuredLight through = measured(*built(std::move(scene)), view);
    // At these steep angles each surface mirrors 4 %. A body has two, and light mirrored twice arrives as well.
    constexpr double kMirrored = 0.04;
    expect_light(through, open.mean * (body ? (1.0 - kMirrored) / (1.0 + kMirrored) : 1.0 - kMirrored));
    EXPECT_LT(through.error, 0.005 * through.mean);
  }
}

/// Each crossing of a half-transparent pane draws its own random number, even for the same pane.
TEST(PathTracer, light_seen_and_arriving_through_a_veil_is_dimmed_twice) {
  constexpr double kAlpha = 0.4;
  for (const int bounces : {0, 1}) {
    scene::Scene scene = scene_of(square_mesh(0.01f));
    scene.model.lights = {overhead_lamp()};
    PanoramaView view = view_of_one_point();
    view.quality.bounces = bounces;
    view.quality.samples = 16;
    const MeasuredLight open = measured(*built(scene), view);
    scene.model.materials.push_back(matte_material(Eigen::Vector3f::Zero()));
    scene.model.materials[1].base_colour.w() = static_cast<float>(kAlpha);
    scene.model.materials[1].alpha_mode = scene::AlphaMode::kBlend;
    add_mesh(scene, square_mesh(20.0f, 1), Eigen::Affine3d(Eigen::Translation3d(0, 0.5, 4.0)));
    const MeasuredLight veiled = measured(*built(std::move(scene)), view);
    expect_light(veiled, (1.0 - kAlpha) * (1.0 - kAlpha) * open.mean);
  }
}

TEST(PathTracer, other_seeds_draw_other_random_numbers_at_a_veil) {
  scene::Scene scene = scene_of(square_mesh(4.0f));
  scene.sky = even_sky();
  scene.model.materials[0].base_colour << 0.0f, 0.0f, 0.0f, 0.5f;
  scene.model.materials[0].alpha_mode = scene::AlphaMode::kBlend;
  const auto renderer = built(std::move(scene));
  PanoramaView view = view_from({0, -1, 1}, 16, 16, 1.0 + 1e-4, 1.0 - 1e-4);
  view.panorama.azimuth_span_rad = 2e-4;
  const Film first = film_of(*renderer, view);
  view.seed = 1;
  EXPECT_NE(first.sum, film_of(*renderer, view).sum);
}

TEST(PathTracer, a_visible_lamp_has_its_radiance_directly_and_in_a_mirror) {
  scene::Scene scene;
  scene.model.materials.push_back(white_material(0.0f, 1.0f));
  add_mesh(scene, square_mesh(0.1f));
  scene::Light lamp = overhead_lamp();
  lamp.position = {0, 1, -1};
  lamp.direction = Eigen::Vector3d(0, -1, 1).normalized();
  lamp.size_m = {0.5, 0.5};
  scene.model.lights = {lamp};
  const auto renderer = built(std::move(scene));
  for (const int bounces : {0, 3}) {
    PanoramaView mirror = view_of_one_point();
    mirror.quality.bounces = bounces;
    const RadianceImage mirrored = film_of(*renderer, mirror).mean();
    for (const float value : mirrored.data()) EXPECT_NEAR(value, 5.0f, 1e-3f);
    PanoramaView straight = mirror;
    straight.eye = {0, 1, 0};
    straight.panorama.tan_elevation_top = 1e-4;
    straight.panorama.tan_elevation_bottom = -1e-4;
    const RadianceImage seen = film_of(*renderer, straight).mean();
    for (const float value : seen.data()) EXPECT_NEAR(value, 5.0f, 1e-3f);
  }
}

}  // namespace
}  // namespace cyclorama::render
