// SPDX-License-Identifier: Apache-2.0
/// The mean picture stays what it was, whatever is done to the way it is sampled. When it has to change:
///   CYCLORAMA_MAKE_GOLDEN=1 CYCLORAMA_SOURCE=. build/release/tests/unit/renderfarm/unit.renderfarm.render.golden_test
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/doubles/simple_scenes.h"
#include "tests/doubles/z_test.h"

namespace cyclorama {
namespace {

constexpr const char* kName = "room";
constexpr int kPiece = 64;

/// Light that goes around in a closed room, a ball that throws a soft shadow, colours that bleed.
std::unique_ptr<Renderer> room() {
  Scene scene = scene_of(sphere_mesh(3.0f, 12), {0.7f, 0.6f, 0.5f});
  scene.model.materials.push_back(matte_material({0.2f, 0.5f, 0.8f}));
  add_mesh(scene, sphere_mesh(0.5f, 8, 1), Eigen::Affine3d(Eigen::Translation3d(0.2, -0.2, -1.6)));
  Light light = point_light({0.8, 1.2, -0.5}, 2.0f);
  light.radius_m = 0.3f;
  scene.model.lights.push_back(light);
  auto built = Renderer::build(std::move(scene), 1, nullptr);
  CHECK(built.has_value());
  return std::move(*built);
}

Film picture(const Renderer& renderer, std::uint64_t seed, int bounces = 3) {
  PanoramaView view = view_from({0, 0, 0.5}, 32, 24, 0.8, -0.8);
  view.panorama.azimuth_span_rad = 2.0;
  view.quality.samples = kPiece;
  view.quality.bounces = bounces;
  view.seed = seed;
  Film film;
  renderer.render_film(view, whole(view), false, &film, nullptr);
  return film;
}

TEST(Golden, the_room_has_the_mean_that_it_had) {
  const auto renderer = room();
  if (std::getenv("CYCLORAMA_MAKE_GOLDEN") != nullptr) {
    constexpr std::uint64_t kPieces = 128;
    GoldenRun run;
    for (std::uint64_t seed = 1; seed <= kPieces; ++seed) run.add(picture(*renderer, seed));
    const std::string text = golden_text(run.result(), "the command in tests/unit/renderfarm/render/golden_test.cpp");
    ASSERT_TRUE(write_file_atomically(golden_path(kName), std::string_view(text)));
  }
  expect_golden(picture(*renderer, 1'000'000), kName);
}

TEST(Golden, a_room_that_lacks_the_last_bounce_is_found) {
  const auto text = read_text_file(golden_path(kName), 1 << 22);
  ASSERT_TRUE(text) << text.error().message();
  const auto golden = parse_golden(*text);
  ASSERT_TRUE(golden) << golden.error().message();
  EXPECT_FALSE(z_test(picture(*room(), 1'000'000, 2), *golden).passed());
}

}  // namespace
}  // namespace cyclorama
