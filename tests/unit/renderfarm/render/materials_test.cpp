// SPDX-License-Identifier: Apache-2.0
/// Appearance of materials in scenes whose picture is known.
#include <gtest/gtest.h>

#include <numbers>

#include "renderfarm/render/lights/light_set.h"
#include "renderfarm/render/renderer.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

std::unique_ptr<Renderer> built(scene::Scene scene) {
  auto renderer = Renderer::build(std::move(scene), 1, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

scene::Sky even_sky(float radiance) {
  const Eigen::Vector3f light = Eigen::Vector3f::Constant(radiance);
  return {light, light, light};
}

/// A wall one metre in front of the eye, `size` wide, with uv (0, 0) in its upper left corner.
Eigen::Affine3d upright(double z = -1.0) {
  return Eigen::Affine3d(Eigen::Translation3d(0, 0, z)) *
         Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX());
}
scene::Scene wall(const Eigen::Vector3f& albedo = Eigen::Vector3f::Constant(0.5f)) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material(albedo));
  add_mesh(scene, square_mesh(2.0f), upright());
  return scene;
}

/// Returns the colour seen straight along (x, y) on the wall, through a narrow view.
Eigen::Vector3f seen(const Renderer& renderer, double x, double y, int samples = 1) {
  PanoramaView view = view_from({x, y, 0}, 1, 1, 1e-4, -1e-4);
  view.panorama.azimuth_span_rad = 2e-4;
  view.quality.samples = samples;
  const RadianceImage image = radiance_of(renderer, view);
  return {image.at(0, 0)[0], image.at(0, 0)[1], image.at(0, 0)[2]};
}

/// Upper left red, upper right green, lower left blue, lower right white.
scene::Texture four_colours() {
  scene::Texture texture;
  texture.pixels = RgbaImage(2, 2, 255);
  texture.nearest = true;
  const std::array<std::array<std::uint8_t, 4>, 4> colours = {
      {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}}};
  for (int i = 0; i < 4; ++i)
    std::copy_n(colours[static_cast<std::size_t>(i)].begin(), 4, texture.pixels.at(i % 2, i / 2));
  return texture;
}

TEST(Materials, a_texture_has_the_right_orientation_by_either_set_of_coordinates) {
  for (const int set : {0, 1}) {
    scene::Scene scene = wall(Eigen::Vector3f::Ones());
    scene.model.textures.push_back(four_colours());
    scene.model.materials[0].base_colour_texture.texture = 0;
    scene.model.materials[0].base_colour_texture.texcoord = set;
    if (set == 1) std::swap(scene.model.meshes[0].texcoords[0], scene.model.meshes[0].texcoords[1]);
    scene.ambient = Eigen::Vector3f::Ones();
    const auto renderer = built(std::move(scene));
    EXPECT_TRUE(seen(*renderer, -0.5, 0.5).isApprox(Eigen::Vector3f(1, 0, 0))) << set;
    EXPECT_TRUE(seen(*renderer, 0.5, 0.5).isApprox(Eigen::Vector3f(0, 1, 0))) << set;
    EXPECT_TRUE(seen(*renderer, -0.5, -0.5).isApprox(Eigen::Vector3f(0, 0, 1))) << set;
    EXPECT_TRUE(seen(*renderer, 0.5, -0.5).isApprox(Eigen::Vector3f(1, 1, 1))) << set;
  }
}

TEST(Materials, a_texture_transform_moves_the_lookup) {
  scene::Scene scene = wall(Eigen::Vector3f::Ones());
  scene.model.textures.push_back(four_colours());
  scene::TextureUse& use = scene.model.materials[0].base_colour_texture;
  use.texture = 0;
  use.transform << 1, 0, 0.5f, 0, 1, 0;  // Half a picture to the right.
  scene.ambient = Eigen::Vector3f::Ones();
  const auto renderer = built(std::move(scene));
  EXPECT_TRUE(seen(*renderer, -0.5, 0.5).isApprox(Eigen::Vector3f(0, 1, 0)));
  EXPECT_TRUE(seen(*renderer, 0.5, 0.5).isApprox(Eigen::Vector3f(1, 0, 0)));
}

TEST(Materials, colour_textures_are_srgb) {
  constexpr float kLinearOf188 = 0.5029f;  // Source: IEC 61966-2-1.
  for (const bool emissive : {false, true}) {
    scene::Scene scene = wall(emissive ? Eigen::Vector3f::Zero() : Eigen::Vector3f::Ones());
    scene.model.textures.emplace_back();
    scene.model.textures[0].pixels = RgbaImage(1, 1, 188);
    scene::Material& material = scene.model.materials[0];
    (emissive ? material.emissive_texture : material.base_colour_texture).texture = 0;
    if (emissive) material.emissive.setOnes();
    scene.ambient = Eigen::Vector3f::Ones();
    EXPECT_NEAR(seen(*built(std::move(scene)), 0.0, 0.0).y(), kLinearOf188, 1e-3f) << emissive;
  }
}

TEST(Materials, vertex_colours_are_srgb_and_multiply) {
  scene::Scene scene = wall({0.5f, 1.0f, 1.0f});
  scene.model.meshes[0].colours.assign(4, {255, 128, 0, 255});
  scene.ambient = Eigen::Vector3f::Ones();
  EXPECT_TRUE(seen(*built(std::move(scene)), 0.1, 0.2).isApprox(Eigen::Vector3f(0.5f, 0.2158605f, 0.0f), 1e-4f));
}

TEST(Materials, a_hole_shows_what_is_behind_and_lets_light_through) {
  for (const bool twice : {false, true}) {  // Baked, and as instances.
    scene::Scene scene = wall();
    scene::Texture mask = four_colours();
    mask.pixels.at(0, 0)[3] = 100;  // Upper left: below the cut-off.
    scene.model.textures.push_back(mask);
    scene.model.materials[0].base_colour_texture.texture = 0;
    scene.model.materials[0].alpha_mode = scene::AlphaMode::kMask;
    if (twice) scene.model.instances.push_back({0, Eigen::Affine3d(Eigen::Translation3d(100, 0, 0))});
    scene.model.materials.push_back(matte_material(Eigen::Vector3f::Ones()));
    add_mesh(scene, square_mesh(2.0f, 1), upright(-2.0));
    scene.model.lights = {point_light({-0.5, 0.5, 0}, static_cast<float>(4.0 * std::numbers::pi))};
    const auto renderer = built(std::move(scene));
    // Straight through the hole: the wall behind, 2 m from the lamp, with albedo 1.
    EXPECT_NEAR(seen(*renderer, -0.5, 0.5).x(), 1.0f, 1e-3f);
    // Where the mask is opaque, the mask itself is visible: green.
    EXPECT_EQ(seen(*renderer, 0.5, 0.5).x(), 0.0f);
    EXPECT_GT(seen(*renderer, 0.5, 0.5).y(), 0.0f);
  }
}

TEST(Materials, half_transparent_layers_add_up_in_order) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material({1, 0, 0}));
  scene.model.materials.push_back(matte_material({0, 1, 0}));
  scene.model.materials.push_back(matte_material({0, 0, 1}));
  scene.model.materials[0].base_colour.w() = 0.5f;
  scene.model.materials[0].alpha_mode = scene::AlphaMode::kBlend;
  scene.model.materials[1].base_colour.w() = 0.25f;
  scene.model.materials[1].alpha_mode = scene::AlphaMode::kBlend;
  for (int i = 0; i < 3; ++i) add_mesh(scene, square_mesh(2.0f, i), upright(-1.0 - i));
  scene.ambient = Eigen::Vector3f::Ones();
  const Eigen::Vector3f expected(0.5f, 0.5f * 0.25f, 0.5f * 0.75f);
  // The layer that a sample sees is random; the random numbers of a pixel's samples are evenly distributed.
  EXPECT_LT((seen(*built(std::move(scene)), 0.1, 0.2, 1024) - expected).norm(), 0.01f);
}

TEST(Materials, many_half_transparent_layers_end_and_keep_the_mean) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material({0, 0, 0}));
  scene.model.materials[0].base_colour.w() = 0.05f;
  scene.model.materials[0].alpha_mode = scene::AlphaMode::kBlend;
  for (int i = 0; i < 40; ++i) add_mesh(scene, square_mesh(20.0f), upright(-1.0 - 0.1 * i));
  scene.sky = even_sky(1.0f);
  EXPECT_NEAR(seen(*built(std::move(scene)), 0, 0, 4096).x(), std::pow(0.95f, 40.0f), 0.02f);
}

TEST(Materials, half_transparent_glass_dims_the_light_behind_it) {
  scene::Scene scene = wall(Eigen::Vector3f::Ones());
  scene.model.materials.push_back(matte_material({0, 0, 0}));
  scene.model.materials[1].base_colour.w() = 0.3f;
  scene.model.materials[1].alpha_mode = scene::AlphaMode::kBlend;
  // Between lamp and wall, but not between eye and wall.
  add_mesh(scene, square_mesh(0.2f, 1),
           Eigen::Affine3d(Eigen::Translation3d(0, 0.9, -0.5)) *
               Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  scene.model.lights = {point_light({0, 1.8, 0}, 10.0f)};
  scene::Scene open = scene;
  open.model.instances.pop_back();
  const float with = seen(*built(std::move(scene)), 0, 0, 4096).x();
  const float without = seen(*built(std::move(open)), 0, 0, 4096).x();
  EXPECT_NEAR(with / without, 0.7f, 0.03f);
}

TEST(Materials, an_emissive_surface_is_visible) {
  scene::Scene scene = wall();
  scene.model.materials[0].emissive = {2.0f, 0.5f, 0.0f};
  EXPECT_TRUE(seen(*built(std::move(scene)), 0, 0).isApprox(Eigen::Vector3f(2.0f, 0.5f, 0.0f)));
}

TEST(Materials, both_sides_are_lit_whatever_the_winding) {
  for (const bool flipped : {false, true}) {
    for (const float normal : {1.0f, -1.0f}) {
      scene::Scene scene = wall();
      scene::Mesh& mesh = scene.model.meshes[0];
      mesh.normals.assign(4, {0, normal, 0});
      if (flipped) {
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
      }
      scene.model.lights = {point_light({0, 0, 0}, static_cast<float>(2.0 * std::numbers::pi))};
      EXPECT_NEAR(seen(*built(std::move(scene)), 0, 0).x(), 1.0f, 1e-3f);
    }
  }
}

/// The bump points to +x in texture space, which is to the right on this wall, so light from the right brightens it.
TEST(Materials, a_normal_map_leans_in_the_direction_of_its_texture) {
  for (const bool tangents : {false, true}) {
    for (const bool mirrored : {false, true}) {
      scene::Scene scene = wall();
      scene::Texture bump;
      bump.pixels = RgbaImage(1, 1, 255);
      // Right by 0.6 and up by 0.3.
      const std::array<std::uint8_t, 4> texel = {204, 166, 222, 255};
      std::copy(texel.begin(), texel.end(), bump.pixels.at(0, 0));
      scene.model.textures.push_back(bump);
      scene.model.materials[0].normal_texture.texture = 0;
      scene::Mesh& mesh = scene.model.meshes[0];
      mesh.normals.assign(4, {0, 1, 0});
      if (tangents) mesh.tangents.assign(4, {1, 0, 0, 1});
      if (mirrored) {  // The same wall with its mesh mirrored and placed by a mirror: the bump points the other way.
        scene.model.instances[0].T_model_mesh = upright() * Eigen::Scaling(-1.0, 1.0, 1.0);
      }
      const auto lit_from = [&](double x, double y) {
        scene::Scene lit = scene;
        lit.model.lights = {point_light({x, y, 0}, 10.0f)};
        return seen(*built(std::move(lit)), 0, 0).x();
      };
      const double right = mirrored ? -1.0 : 1.0;
      SCOPED_TRACE(testing::Message() << (tangents ? "tangents given" : "tangents derived")
                                      << (mirrored ? ", mirrored" : ""));
      EXPECT_GT(lit_from(right, 0), 2.0f * lit_from(-right, 0));
      EXPECT_GT(lit_from(0, 1), 1.3f * lit_from(0, -1));
    }
  }
}

TEST(Materials, a_polished_metal_mirrors_the_lamp_and_a_matte_wall_does_not) {
  const auto lit = [](float roughness, double lamp_x) {
    scene::Scene scene = wall(Eigen::Vector3f::Constant(0.9f));
    scene.model.materials[0].metallic = 1.0f;
    scene.model.materials[0].roughness = roughness;
    scene.model.lights = {point_light({lamp_x, 0, 0}, 1.0f)};
    return seen(*built(std::move(scene)), 0, 0).x();
  };
  EXPECT_GT(lit(0.1f, 0.0), 100.0f * lit(0.1f, 1.0));
  EXPECT_LT(lit(0.9f, 0.0), 10.0f * lit(0.9f, 1.0));
}

TEST(Materials, a_white_metal_under_an_even_sky_is_nearly_as_bright) {
  for (const float roughness : {0.1f, 0.3f}) {
    scene::Scene scene = wall(Eigen::Vector3f::Ones());
    scene.model.materials[0].metallic = 1.0f;
    scene.model.materials[0].roughness = roughness;
    scene.sky = even_sky(1.0f);
    const float radiance = seen(*built(std::move(scene)), 0, 0, 4096).x();
    EXPECT_LE(radiance, 1.005f);
    EXPECT_GE(radiance, 0.95f);
  }
}

TEST(Materials, a_coarse_mirror_ball_has_no_black_rings) {
  scene::Mesh ball = sphere_mesh(1.0f, 8);
  for (const auto& p : ball.positions) ball.normals.push_back(p);
  scene::Scene scene = scene_of(std::move(ball), Eigen::Vector3f::Constant(0.9f));
  scene.model.materials[0].metallic = 1.0f;
  scene.model.materials[0].roughness = 0.0f;
  scene.sky = even_sky(1.0f);
  PanoramaView view = view_from({0, 0, 3}, 64, 64, 0.34, -0.34);
  view.panorama.azimuth_span_rad = 0.6;
  view.quality.samples = 16;
  const RadianceImage image = radiance_of(*built(std::move(scene)), view);
  int dark = 0;
  for (const float value : image.data()) dark += value < 0.5f ? 1 : 0;
  EXPECT_EQ(dark, 0);
}

/// A board half a metre wide, 1 m above the floor, under a lamp of radius r, 2 m above it: umbra in the middle, no
/// shadow far out, and a penumbra between them at the geometric position.
TEST(Materials, a_sphere_light_makes_a_penumbra_within_its_bounds) {
  scene::Scene scene = scene_of(square_mesh(20.0f));
  add_mesh(scene, square_mesh(1.0f), Eigen::Affine3d(Eigen::Translation3d(0, 1, 0)));
  scene.model.lights = {point_light({0, 2, 0}, 10.0f)};
  scene.model.lights[0].radius_m = 0.2;
  scene::Scene open = scene;
  open.model.instances.pop_back();
  const auto shaded = built(std::move(scene));
  const auto unshaded = built(std::move(open));
  // The edge at x = 0.5 casts its shadow's edge to x = 1; the lamp's width spreads it by about 0.2 to each side.
  const auto part = [&](double x) {
    PanoramaView view = view_from({x, 0.5, 0.001}, 1, 1, -500.0, -500.5);
    view.panorama.azimuth_span_rad = 1e-3;
    view.quality.samples = 1024;
    return radiance_of(*shaded, view).at(0, 0)[0] / radiance_of(*unshaded, view).at(0, 0)[0];
  };
  EXPECT_EQ(part(0.0), 0.0f);
  EXPECT_EQ(part(0.75), 0.0f);
  EXPECT_NEAR(part(1.0), 0.5f, 0.1f);
  EXPECT_GT(part(0.9), 0.02f);
  EXPECT_LT(part(0.9), part(1.0));
  EXPECT_LT(part(1.0), part(1.1));
  EXPECT_LT(part(1.1), 0.98f);
  EXPECT_NEAR(part(1.3), 1.0f, 1e-3f);
}

TEST(Materials, the_eye_lamp_follows_the_inverse_square_law_and_casts_no_shadow) {
  scene::Scene scene = wall();
  scene.eye_lamp = Eigen::Vector3f::Constant(static_cast<float>(2.0 * std::numbers::pi));
  const auto renderer = built(std::move(scene));
  EXPECT_NEAR(seen(*renderer, 0, 0).x(), 1.0f, 1e-3f);
  PanoramaView view = view_from({0, 0, 1}, 1, 1, 1e-4, -1e-4);
  view.panorama.azimuth_span_rad = 2e-4;
  EXPECT_NEAR(radiance_of(*renderer, view).at(0, 0)[0], 0.25f, 1e-3f);
}

TEST(Materials, light_is_the_sum_of_its_groups_at_their_levels) {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 24));
  scene.model.materials[0].base_colour.head<3>().setConstant(0.5f);
  scene.ambient.setConstant(0.1f);
  scene::Light disk = point_light({0, 2, 0}, 3.0f);
  disk.kind = scene::LightKind::kDisk;
  disk.radius_m = 0.5;
  scene.model.lights = {point_light({0, -1, 0}, 5.0f), disk};
  scene.model.lights[0].radius_m = 0.1;
  scene.model.lights[0].group = 1;
  scene.model.lights[1].group = 2;
  const auto renderer = built(std::move(scene));
  const auto light_at = [&](std::vector<float> levels) {
    PanoramaView view = view_from({0.3, 0.2, 0.1}, 32, 16, 2.0, -2.0);
    view.quality.bounces = 2;
    view.quality.samples = 4;
    view.lamps = scene::levels_of(levels);
    return mean_of(radiance_of(*renderer, view));
  };
  const double rest = light_at({0.0f, 0.0f});
  const double first = light_at({1.0f, 0.0f}) - rest;
  const double second = light_at({0.0f, 1.0f}) - rest;
  EXPECT_GT(first, 0.1 * rest);
  EXPECT_GT(second, 0.1 * rest);
  EXPECT_NEAR(light_at({}), rest + first + second, 1e-5);
  EXPECT_NEAR(light_at({0.5f, 3.0f}), rest + 0.5 * first + 3.0 * second, 1e-5);
}

TEST(Materials, the_eye_lamp_gives_no_indirect_light) {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 24));
  scene.model.materials[0].base_colour.head<3>().setConstant(0.9f);
  scene.eye_lamp.setConstant(5.0f);
  const auto renderer = built(std::move(scene));
  PanoramaView view = view_from({0.3, 0.2, 0.1}, 32, 16, 2.0, -2.0);
  view.quality.bounces = 0;
  const double direct = mean_of(radiance_of(*renderer, view));
  EXPECT_GT(direct, 0.0);
  view.quality.bounces = 8;
  EXPECT_NEAR(mean_of(radiance_of(*renderer, view)), direct, 1e-6 * direct);
}

TEST(Materials, an_unlit_surface_shows_its_base_colour_whatever_light_there_is) {
  for (const bool lit : {false, true}) {
    scene::Scene scene = wall(Eigen::Vector3f(0.5f, 0.75f, 1.0f));
    scene.model.textures.push_back(four_colours());
    scene::Material& material = scene.model.materials[0];
    material.unlit = true;
    material.roughness = 0.1f;
    material.base_colour_texture.texture = 0;
    if (lit) {
      scene.sky = even_sky(3.0f);
      scene.ambient.setConstant(0.5f);
      scene.model.lights = {point_light({0, 0, 0}, 10.0f)};
      scene.eye_lamp.setConstant(2.0f);
    }
    const auto renderer = built(std::move(scene));
    EXPECT_EQ(renderer->lights().triangles(), 0u) << "no lamp";
    EXPECT_TRUE(seen(*renderer, -0.5, 0.5, 4).isApprox(Eigen::Vector3f(0.5f, 0, 0))) << lit;
    EXPECT_TRUE(seen(*renderer, 0.5, -0.5, 4).isApprox(Eigen::Vector3f(0.5f, 0.75f, 1))) << lit;
  }
}

TEST(Materials, no_light_leaks_into_a_closed_room) {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 24));
  scene.sky = even_sky(1000.0f);
  scene.model.lights = {point_light({0, 10, 0}, 1e6f)};
  PanoramaView view = view_from({0.3, 0.2, 0.1}, 128, 64, 2.0, -2.0);
  view.quality.samples = 8;
  EXPECT_EQ(mean_of(radiance_of(*built(std::move(scene)), view)), 0.0);
}

}  // namespace
}  // namespace cyclorama::render
