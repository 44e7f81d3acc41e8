// SPDX-License-Identifier: Apache-2.0
/// The level that a material is rendered at shows whatever its factors reach through its textures.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "renderfarm/render/renderer.h"
#include "renderfarm/render/requirements.h"
#include "tests/data_sets/simple_scenes.h"
#include "tests/unit/renderfarm/render/bsdf_cases.h"

namespace cyclorama::render {
namespace {

/// A factor of a material and the channel of the texture that multiplies it.
struct Slot {
  const char* name;
  float scene::Material::*factor;
  scene::TextureUse scene::Material::*use;
  std::size_t channel;
  float SurfaceTexels::*texel;
};
constexpr std::array<Slot, 6> kSlots = {
    {{"metallic", &scene::Material::metallic, &scene::Material::metallic_roughness_texture, 2,
      &SurfaceTexels::metallic},
     {"roughness", &scene::Material::roughness, &scene::Material::metallic_roughness_texture, 1,
      &SurfaceTexels::roughness},
     {"specular", &scene::Material::specular, &scene::Material::specular_texture, 3, &SurfaceTexels::specular},
     {"clearcoat", &scene::Material::clearcoat, &scene::Material::clearcoat_texture, 0, &SurfaceTexels::clearcoat},
     {"clearcoat roughness", &scene::Material::clearcoat_roughness, &scene::Material::clearcoat_roughness_texture, 1,
      &SurfaceTexels::clearcoat_roughness},
     {"transmission", &scene::Material::transmission, &scene::Material::transmission_texture, 0,
      &SurfaceTexels::transmission}}};

/// A texture of two texels, equal but for one channel.
scene::Texture two_texels(std::size_t channel, std::uint8_t first, std::uint8_t second) {
  scene::Texture texture;
  texture.pixels = RgbaImage(2, 1, 255);
  texture.pixels.at(0, 0)[channel] = first;
  texture.pixels.at(1, 0)[channel] = second;
  return texture;
}

/// Materials that differ in every factor but the one under test.
std::vector<scene::Material> surroundings() {
  std::vector<scene::Material> all;
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    for (const float roughness : {0.4f, 1.0f}) {
      for (const float layer : {0.0f, 0.5f}) {
        scene::Material material = white_material(roughness);
        material.base_colour.head<3>() << 0.8f, 0.4f, 0.1f;
        material.metallic = metallic;
        material.clearcoat = layer;
        all.push_back(material);
        material.clearcoat = 0.0f;
        material.transmission = layer;
        all.push_back(material);
      }
    }
  }
  return all;
}

Vec3 in_plane(float sine) { return {sine, 0.0f, std::sqrt(1.0f - sine * sine)}; }

template <SurfaceLevel kLevel>
std::vector<float> reflected(const scene::Material& material, const SurfaceTexels& texels) {
  std::vector<float> values;
  for (const float sine_o : {0.1f, 0.7f}) {
    const Bsdf bsdf = make_bsdf(material, texels, false, kLevel);
    const Scattering<kLevel> scattering(bsdf, Vec3::UnitZ(), in_plane(sine_o));
    for (const float sine_i : {-0.7f, -0.1f, 0.5f}) {
      const Vec3 above = scattering.evaluate(in_plane(sine_i));
      const Vec3 below = scattering.evaluate(-in_plane(sine_i));
      values.insert(values.end(), {above.x(), above.y(), above.z(), below.x(), below.y(), below.z()});
    }
    const Vec3 albedo = scattering.albedo();
    values.insert(values.end(), {albedo.x(), albedo.y(), albedo.z()});
  }
  return values;
}

std::vector<float> reflected(SurfaceLevel level, const scene::Material& material, const SurfaceTexels& texels) {
  if (level == SurfaceLevel::kMatte) return reflected<SurfaceLevel::kMatte>(material, texels);
  if (level == SurfaceLevel::kGlossy) return reflected<SurfaceLevel::kGlossy>(material, texels);
  return reflected<SurfaceLevel::kLayered>(material, texels);
}

/// A rough dielectric's gloss is left out by intent: Lambertian reflection stands for both. This is the largest
/// difference over the cases below.
float tolerance(SurfaceLevel level) { return level == SurfaceLevel::kMatte ? 0.05f : 1e-5f; }

TEST(SurfaceLevel, of_each_texture_and_factor_at_its_ends_reflects_as_the_general_one_does) {
  for (const Slot& slot : kSlots) {
    for (const scene::Material& surrounding : surroundings()) {
      for (const float factor : {0.0f, 1.0f}) {
        for (const auto& [first, second] :
             {std::pair{0, 0}, std::pair{0, 255}, std::pair{255, 0}, std::pair{255, 255}}) {
          scene::Material material = surrounding;
          material.*slot.factor = factor;
          (material.*slot.use).texture = 0;
          const auto codes = std::array{static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(second)};
          const SurfaceLevel level = surface_level_of(material, {two_texels(slot.channel, codes[0], codes[1])});
          for (const std::uint8_t code : codes) {
            SurfaceTexels texels;
            texels.*slot.texel = code == 0 ? 0.0f : 1.0f;
            const std::vector<float> own = reflected(level, material, texels);
            const std::vector<float> general = reflected(SurfaceLevel::kLayered, material, texels);
            for (std::size_t i = 0; i < own.size(); ++i) {
              ASSERT_NEAR(own[i], general[i], tolerance(level) + 1e-4f * std::abs(general[i]))
                  << slot.name << " " << factor << ", texels " << first << " and " << second << ", metallic "
                  << surrounding.metallic << ", roughness " << surrounding.roughness << ", value " << i;
            }
          }
        }
      }
    }
  }
}

TEST(SurfaceLevel, is_glossy_where_a_texture_smooths_a_dielectric_of_roughness_1) {
  scene::Material material = white_material(1.0f);
  material.metallic_roughness_texture.texture = 0;
  EXPECT_EQ(surface_level_of(material, {two_texels(1, 255, 50)}), SurfaceLevel::kGlossy);
  EXPECT_EQ(surface_level_of(material, {two_texels(1, 255, 255)}), SurfaceLevel::kMatte);
}

TEST(SurfaceLevel, leaves_out_what_a_texture_of_zeros_takes_away) {
  scene::Material material = white_material(1.0f);
  material.metallic = 1.0f;
  material.metallic_roughness_texture.texture = 0;
  EXPECT_EQ(surface_level_of(material, {two_texels(2, 0, 0)}), SurfaceLevel::kMatte);
  EXPECT_EQ(surface_level_of(material, {two_texels(2, 0, 1)}), SurfaceLevel::kGlossy);
  material.clearcoat = 1.0f;
  material.clearcoat_texture.texture = 0;
  EXPECT_EQ(surface_level_of(material, {two_texels(0, 0, 0)}), SurfaceLevel::kGlossy);
  EXPECT_EQ(surface_level_of(material, {scene::Texture{}}), SurfaceLevel::kLayered) << "no pixels: as without texture";
}

/// Returns the light that a square above the eye reflects from a lamp beside it, through a texture of roughness.
double light_of(std::uint8_t roughness_code) {
  scene::Scene scene = scene_of(square_mesh(2.0f), Eigen::Vector3f::Zero());
  scene.model.textures.push_back(two_texels(1, roughness_code, roughness_code));
  scene.model.materials[0].metallic_roughness_texture.texture = 0;
  scene.model.lights.push_back(point_light({0.0, 1.0, 0.4}, 1.0f));
  const auto renderer = Renderer::build(std::move(scene), 1, nullptr);
  PanoramaView view = view_from({0.0, 1.0, -0.4}, 64, 32, -0.5, -4.0);
  view.quality.samples = 16;
  return mean_of(radiance_of(**renderer, view));
}

TEST(SurfaceLevel, a_texture_polishes_black_stone_whose_roughness_factor_is_1) {
  EXPECT_EQ(light_of(255), 0.0);
  EXPECT_GT(light_of(77), 1e-4);
}

}  // namespace
}  // namespace cyclorama::render
