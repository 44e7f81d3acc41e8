// SPDX-License-Identifier: Apache-2.0
/// Light that crosses thin glass on its way from a lamp to a surface.
#include "renderfarm/render/pane.h"

#include <gtest/gtest.h>

#include "renderfarm/render/bsdf/layered.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/scene/thin_glass.h"
#include "tests/data_sets/vitrine.h"

namespace cyclorama::render {
namespace {

constexpr float kFloorAlbedo = 0.1f;  // Dark, so that hardly any light returns from the glass.

scene::Material glass(const Eigen::Vector3f& tint = Eigen::Vector3f::Ones()) {
  scene::Material material = matte_material(tint);
  material.roughness = 0.0f;
  material.transmission = 1.0f;
  return material;
}

/// A floor at y = 0 with `material`; sheets of glass may be added with material 1.
scene::Scene floor_of(const scene::Material& material, const Eigen::Vector3f& tint = Eigen::Vector3f::Ones()) {
  scene::Scene scene = scene_of(square_mesh(1.9f));
  scene.model.materials = {material, glass(tint)};
  return scene;
}
scene::Scene dark_floor(const Eigen::Vector3f& tint = Eigen::Vector3f::Ones()) {
  return floor_of(matte_material(Eigen::Vector3f::Constant(kFloorAlbedo)), tint);
}
void add_sheet(scene::Scene& scene, double height, float size = 8.0f) {
  add_mesh(scene, square_mesh(size, 1), Eigen::Affine3d(Eigen::Translation3d(0, height, 0)));
}
/// Five sheets around the floor, 2 m wide and 1 m high.
void add_vitrine(scene::Scene& scene) {
  add_sheet(scene, 1.0, 2.0f);
  for (int side = 0; side < 4; ++side) {
    add_mesh(scene, square_mesh(2.0f, 1),
             Eigen::AngleAxisd(0.5 * std::numbers::pi * side, Eigen::Vector3d::UnitY()) *
                 Eigen::Translation3d(0, 0, 1.0) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  }
}

/// Returns the light of the floor's middle, seen from within the vitrine.
Eigen::Vector3d seen(scene::Scene scene, int samples, int bounces) {
  const auto renderer = Renderer::build(std::move(scene), 2, nullptr);
  EXPECT_TRUE(renderer.has_value());
  PanoramaView view = view_from({0, 0.4, 0.8}, 16, 16, -0.499, -0.501);
  view.panorama.azimuth_span_rad = 2e-3;
  view.quality.samples = samples;
  view.quality.bounces = bounces;
  const RadianceImage image = radiance_of(**renderer, view);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < image.data().size(); ++i)
    sum[static_cast<Eigen::Index>(i % 3)] += double{image.data()[i]};
  return sum / 256.0;
}

/// The part of the light that a clear sheet lets through at an angle.
double let_through(double cosine) {
  const Bsdf bsdf = make_bsdf(glass(), SurfaceTexels{}, false, SurfaceLevel::kLayered);
  const Vec3 wo(static_cast<float>(std::sqrt(1.0 - cosine * cosine)), 0.0f, static_cast<float>(cosine));
  return double{Scattering<SurfaceLevel::kLayered>(bsdf, Vec3::UnitZ(), wo).straight().x()};
}

TEST(Panes, are_thin_and_smooth_and_transmit) {
  scene::Material material = glass();
  EXPECT_TRUE(is_pane(material, surface_level_of(material, {})));
  material.thickness = 0.01f;
  EXPECT_FALSE(is_pane(material, surface_level_of(material, {}))) << "a body";
  material = glass();
  material.roughness = 0.5f;
  EXPECT_FALSE(is_pane(material, surface_level_of(material, {}))) << "frosted";
  material = glass();
  material.transmission = 0.0f;
  EXPECT_FALSE(is_pane(material, surface_level_of(material, {})));
}

TEST(Panes, leave_what_fresnel_and_tint_leave_of_a_lamp_without_size) {
  const Eigen::Vector3f tint(0.9f, 0.5f, 0.1f);
  for (const int panes : {0, 1, 2, 3}) {
    scene::Scene scene = dark_floor(tint);
    scene.model.lights.push_back(point_light({0, 2, 0}, 10.0f));
    for (int i = 0; i < panes; ++i) add_sheet(scene, 1.0 + 0.1 * i);
    const Eigen::Vector3d light = seen(std::move(scene), 1, 0);
    for (int c = 0; c < 3; ++c) {
      const double part = std::pow(0.96 * double{tint[c]}, panes);
      EXPECT_NEAR(light[c], part * double{kFloorAlbedo} / std::numbers::pi * 10.0 / 4.0, 1e-5) << panes;
    }
  }
}

TEST(Panes, of_a_part_that_is_drawn_twice_leave_the_same) {
  scene::Scene scene = dark_floor();
  scene.model.lights.push_back(point_light({0, 2, 0}, 10.0f));
  add_sheet(scene, 1.0);
  scene.model.instances.push_back(scene.model.instances.back());
  scene.model.instances.back().T_model_mesh.translate(Eigen::Vector3d(0, 0.25, 0));
  EXPECT_NEAR(seen(std::move(scene), 1, 0).x(), 0.96 * 0.96 * double{kFloorAlbedo} / std::numbers::pi * 2.5, 1e-5);
}

TEST(Panes, still_stop_light_where_their_texture_transmits_nothing) {
  scene::Scene scene = dark_floor();
  scene.model.lights.push_back(point_light({0, 2, 0}, 10.0f));
  scene.model.textures.emplace_back();
  scene.model.textures[0].pixels = RgbaImage(2, 1, 255);
  scene.model.textures[0].nearest = true;
  scene.model.textures[0].pixels.at(0, 0)[0] = 0;
  scene.model.materials[1].transmission_texture.texture = 0;
  add_mesh(scene, square_mesh(8.0f, 1), Eigen::Affine3d(Eigen::Translation3d(1, 1, 0)));  // Its dark half is above.
  EXPECT_EQ(seen(scene, 1, 0).x(), 0.0);
  scene.model.instances.back().T_model_mesh = Eigen::Translation3d(-1, 1, 0);
  EXPECT_GT(seen(std::move(scene), 1, 0).x(), 0.0);
}

TEST(Panes, of_a_vitrine_leave_of_the_sky_what_they_let_through_in_every_direction) {
  double expected = 0.0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    for (int k = 0; k < kSteps; ++k) {
      // Directions about the floor's normal, by their projection on the floor.
      const double x = (i + 0.5) / kSteps * 2.0 - 1.0;
      const double z = (k + 0.5) / kSteps * 2.0 - 1.0;
      const double r2 = x * x + z * z;
      if (r2 >= 1.0) continue;
      const double y = std::sqrt(1.0 - r2);
      expected += let_through(std::max({y, std::abs(x), std::abs(z)}));  // The vitrine is twice as wide as high.
    }
  }
  expected *= 4.0 / kSteps / kSteps * double{kFloorAlbedo} / std::numbers::pi;
  for (const int bounces : {0, 1}) {
    scene::Scene scene = dark_floor();
    add_vitrine(scene);
    scene.sky = {Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones()};
    const double light = seen(std::move(scene), 64, bounces).x();
    EXPECT_GT(light, 0.99 * expected) << bounces;
    // Paths of two surfaces also find the sky's mirror image in the glass.
    EXPECT_LT(light, (bounces == 0 ? 1.01 : 1.05) * expected) << bounces;
  }
}

TEST(Panes, do_not_count_a_lamp_twice_that_rays_meet_as_well) {
  for (const float roughness : {1.0f, 0.45f, 0.2f}) {
    scene::Material floor = matte_material(Eigen::Vector3f::Constant(0.5f));
    floor.roughness = roughness;
    floor.metallic = roughness < 1.0f ? 1.0f : 0.0f;
    double without = 0.0;
    for (const bool behind_glass : {false, true}) {
      scene::Scene scene = floor_of(floor);
      scene::Light lamp = point_light({0, 3.0, -6.0}, 100.0f);
      lamp.radius_m = 1.0;
      lamp.visible = true;
      scene.model.lights.push_back(lamp);
      // Between floor and lamp, and facing the light that arrives.
      if (behind_glass) {
        add_mesh(scene, square_mesh(3.0f, 1),
                 Eigen::Translation3d(0, 1.0, -2.0) *
                     Eigen::AngleAxisd(-std::atan2(6.0, 3.0), Eigen::Vector3d::UnitX()) * Eigen::Affine3d::Identity());
      }
      for (const int bounces : {0, 1}) {
        const double light = seen(scene, 64, bounces).x();
        if (!behind_glass) {
          without = light;
        } else {
          EXPECT_NEAR(light / without, 0.96, 0.01) << "roughness " << roughness << ", bounces " << bounces;
        }
      }
    }
  }
}

TEST(Panes, of_a_vitrine_with_thick_plates_show_what_many_paths_through_the_glass_show) {
  const auto mean = [](scene::Scene scene, int samples) {
    const auto renderer = Renderer::build(std::move(scene), 2, nullptr);
    return mean_of(radiance_of(**renderer, view_into_vitrine(16, samples, 4, 1)));
  };
  scene::Scene solid = vitrine(VitrineLight::kDisk);
  scene::Scene thin = solid;
  scene::make_plates_thin(&thin.model);
  EXPECT_NEAR(mean(std::move(thin), 16) / mean(std::move(solid), 2048), 1.0, 0.02);
}

}  // namespace
}  // namespace cyclorama::render
