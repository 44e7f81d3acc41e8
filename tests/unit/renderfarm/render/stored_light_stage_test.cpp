// SPDX-License-Identifier: Apache-2.0
// Pictures of stored light, whose paths end early, against the same pictures shaded as a whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "renderfarm/light/light_store.h"
#include "renderfarm/light/rgb9e5.h"
#include "renderfarm/light/scene_key.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/trace_scene.h"
#include "tests/data_sets/mixed_room.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

std::unique_ptr<Renderer> built(scene::Scene scene) {
  auto renderer = Renderer::build(std::move(scene), 2, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

/// Light that differs from vertex to vertex and from side to side; every seventh sample is missing.
std::shared_ptr<const light::LightStore> made_up_light(const Renderer& renderer) {
  auto store = std::make_shared<light::LightStore>();
  store->scene = light::key_of(renderer.scene());
  store->unit = 2.0f;
  std::uint32_t number = 0;
  for (const Placement& placement : renderer.traced().placements) {
    light::SurfaceLight surface;
    surface.base_per_triangle = placement.mesh->normals == nullptr;
    const std::size_t count = surface.base_per_triangle ? placement.mesh->triangle_count : placement.mesh->vertex_count;
    for (light::SideLight& side : surface.sides) {
      for (std::size_t i = 0; i < count; ++i, ++number) {
        const auto level = static_cast<float>(number % 5 + 1) * 0.1f;
        side.base.push_back(number % 7 == 0 ? light::kNoSample : light::to_rgb9e5({level, 0.5f * level, 0.2f}));
      }
    }
    store->surfaces.push_back(std::move(surface));
  }
  return store;
}

PanoramaView view_of(int samples) {
  PanoramaView view = view_from({0.1, 0.2, 0.5}, 160, 64, 0.8, -0.8);
  view.panorama.azimuth_span_rad = 2.6;
  view.quality.samples = samples;
  view.quality.bounces = 2;
  view.quality.stored_light = true;
  return view;
}

RadianceImage picture_of(const Renderer& renderer, const PanoramaView& view, bool with_features) {
  Film film;
  (void)renderer.render_film(view, {0, 0, view.panorama.width_px, view.panorama.height_px}, with_features, &film,
                             nullptr);
  return film.mean();
}

float largest_difference(const RadianceImage& a, const RadianceImage& b) {
  float largest = 0.0f;
  for (std::size_t i = 0; i < a.data().size(); ++i) largest = std::max(largest, std::abs(a.data()[i] - b.data()[i]));
  return largest;
}

/// A view with features is shaded as a whole, which is the reference.
void expect_same_as_shaded(scene::Scene scene) {
  auto renderer = built(std::move(scene));
  ASSERT_TRUE(renderer->set_light(made_up_light(*renderer), "made up").has_value());
  for (const int samples : {1, 4}) {
    const PanoramaView view = view_of(samples);
    const RadianceImage early = picture_of(*renderer, view, false);
    const RadianceImage shaded = picture_of(*renderer, view, true);
    EXPECT_LT(largest_difference(early, shaded), 2e-5f) << samples << " samples";
    EXPECT_GT(*std::max_element(early.data().begin(), early.data().end()), 0.05f) << "the picture is black";
  }
}

TEST(PathsThatEndAtStoredLight, show_a_room_of_all_materials_as_if_shaded) { expect_same_as_shaded(mixed_room()); }

TEST(PathsThatEndAtStoredLight, see_the_same_side_of_mirrored_instances) {
  scene::Scene scene = scene_of(square_mesh(1.0f));
  for (const double side : {-1.0, 1.0}) {
    Eigen::Affine3d placed(Eigen::Translation3d(side, 0.0, -2.0));
    placed.linear() = Eigen::Vector3d(side, 0.7, 1.3).asDiagonal();
    scene.model.instances.push_back({0, placed * Eigen::AngleAxisd(1.2, Eigen::Vector3d(side, 1.0, 0.3).normalized())});
  }
  expect_same_as_shaded(std::move(scene));
}

TEST(PathsThatEndAtStoredLight, make_the_same_pixels_in_parts_of_a_picture) {
  auto renderer = built(mixed_room());
  ASSERT_TRUE(renderer->set_light(made_up_light(*renderer), "made up").has_value());
  const PanoramaView view = view_of(4);
  RgbImage whole;
  (void)renderer->render(view, {0, 0, 160, 64}, &whole, nullptr);
  for (const PixelRect part : {PixelRect{0, 0, 80, 64}, PixelRect{37, 5, 61, 40}}) {
    RgbImage pixels;
    (void)renderer->render(view, part, &pixels, nullptr);
    for (int y = 0; y < part.height; ++y) {
      EXPECT_TRUE(std::equal(pixels.at(0, y), pixels.at(0, y) + 3 * part.width, whole.at(part.x, part.y + y))) << y;
    }
  }
}

}  // namespace
}  // namespace cyclorama::render
