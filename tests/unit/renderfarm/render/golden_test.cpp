// SPDX-License-Identifier: Apache-2.0
/// The mean picture must not change, however sampling is implemented. If a change is intended:
///   CYCLORAMA_MAKE_GOLDEN=1 CYCLORAMA_SOURCE=. build/release/tests/unit/renderfarm/unit.renderfarm.render.golden_test
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <utility>

#include "tests/data_sets/mixed_room.h"
#include "tests/support/z_test.h"

namespace cyclorama::render {
namespace {

constexpr int kPiece = 64;

std::unique_ptr<Renderer> renderer_of(scene::Scene scene) {
  auto built = Renderer::build(std::move(scene), 1, nullptr);
  CHECK(built.has_value());
  return std::move(*built);
}

/// Interreflection in a closed room, with a ball that casts a soft shadow, and colour bleeding.
std::unique_ptr<Renderer> room() {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 12), {0.7f, 0.6f, 0.5f});
  scene.model.materials.push_back(matte_material({0.2f, 0.5f, 0.8f}));
  add_mesh(scene, sphere_mesh(0.5f, 8, 1), Eigen::Affine3d(Eigen::Translation3d(0.2, -0.2, -1.6)));
  scene::Light light = point_light({0.8, 1.2, -0.5}, 2.0f);
  light.radius_m = 0.3f;
  scene.model.lights.push_back(light);
  return renderer_of(std::move(scene));
}

/// A lamp with edges: soft shadows, direct light only.
std::unique_ptr<Renderer> lamp_room() {
  scene::Scene scene = scene_of(sphere_mesh(3.0f, 12), {0.7f, 0.6f, 0.5f});
  add_mesh(scene, sphere_mesh(0.5f, 8), Eigen::Affine3d(Eigen::Translation3d(0.2, -0.4, -1.6)));
  scene::Light light;
  light.kind = scene::LightKind::kRectangle;
  light.position = {0.4, 1.2, -1.4};
  light.direction = Eigen::Vector3d(-0.1, -1.0, 0.1).normalized();
  light.size_m = {1.0, 0.5};
  light.intensity.setConstant(4.0f);
  light.visible = true;
  scene.model.lights.push_back(light);
  return renderer_of(std::move(scene));
}

/// Metal, plastic, lacquer and glass outdoors, under a sky with a sun.
std::unique_ptr<Renderer> garden() {
  scene::Scene scene = scene_of(square_mesh(8.0f), {0.5f, 0.5f, 0.4f});
  for (const auto& [roughness, metallic] : {std::pair{0.2f, 1.0f}, std::pair{0.4f, 0.0f}, std::pair{0.6f, 0.5f}}) {
    scene.model.materials.push_back(white_material(roughness, metallic));
  }
  scene.model.materials[3].clearcoat = 1.0f;
  scene.model.materials.push_back(white_material(0.2f, 0.0f));
  scene.model.materials[4].transmission = 1.0f;
  scene.model.materials[4].thickness = 1.0f;
  for (int i = 0; i < 4; ++i) {
    add_mesh(scene, sphere_mesh(0.4f, 8, i + 1), Eigen::Affine3d(Eigen::Translation3d(0.9 * i - 1.3, 0.4, -1.6)));
  }
  auto map = std::make_shared<scene::EnvironmentMap>();
  map->pixels = RadianceImage(16, 8, 0.4f);
  std::fill_n(map->pixels.at(9, 1), 3, 6.0f);
  scene.environment = map;
  return renderer_of(std::move(scene));
}

struct GoldenScene {
  const char* name;
  std::unique_ptr<Renderer> (*make)();
  Eigen::Vector3d eye;
  int bounces;
};
constexpr const char* kRoom = "room";
const std::array<GoldenScene, 3> kScenes = {
    {{kRoom, &room, {0, 0, 0.5}, 3}, {"lamp_room", &lamp_room, {0, 0, 0.5}, 0}, {"garden", &garden, {0, 0.9, 0.5}, 4}}};

Film picture(const Renderer& renderer, const GoldenScene& at, std::uint64_t seed) {
  PanoramaView view = view_from(at.eye, 32, 24, 0.8, -0.8);
  view.panorama.azimuth_span_rad = 2.0;
  view.quality.samples = kPiece;
  view.quality.bounces = at.bounces;
  view.seed = seed;
  Film film;
  renderer.render_film(view, whole(view), false, &film, nullptr);
  return film;
}

TEST(Golden, pictures_have_the_stored_mean) {
  for (const GoldenScene& at : kScenes) {
    SCOPED_TRACE(at.name);
    const auto renderer = at.make();
    if (std::getenv("CYCLORAMA_MAKE_GOLDEN") != nullptr) {
      constexpr std::uint64_t kPieces = 128;
      GoldenRun run;
      for (std::uint64_t seed = 1; seed <= kPieces; ++seed) run.add(picture(*renderer, at, seed));
      const std::string text = golden_text(run.result(), "the command in tests/unit/renderfarm/render/golden_test.cpp");
      ASSERT_TRUE(write_file_atomically(golden_path(at.name), std::string_view(text)));
    }
    expect_golden(picture(*renderer, at, 1'000'000), at.name);
  }
}

TEST(Golden, a_missing_last_bounce_is_detected) {
  const auto text = read_text_file(golden_path(kRoom), 1 << 22);
  ASSERT_TRUE(text) << text.error().message();
  const auto golden = parse_golden(*text);
  ASSERT_TRUE(golden) << golden.error().message();
  GoldenScene at = kScenes[0];
  --at.bounces;
  EXPECT_FALSE(z_test(picture(*room(), at, 1'000'000), *golden).passed());
}

}  // namespace
}  // namespace cyclorama::render
