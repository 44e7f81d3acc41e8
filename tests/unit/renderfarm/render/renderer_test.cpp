// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "renderfarm/render/memory.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::render {
namespace {

std::unique_ptr<Renderer> built(scene::Scene scene, int threads = 2) {
  auto renderer = Renderer::build(std::move(scene), threads, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

/// A room with boxes, lamps and sky, which exercises every part of the plain kernels.
scene::Scene busy_scene(const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  scene::Mesh floor = square_mesh(10.0f);
  floor.origin = shift;
  scene::Scene scene = scene_of(std::move(floor), {0.6f, 0.5f, 0.4f});
  for (int i = 0; i < 5; ++i) {
    scene::Mesh ball = sphere_mesh(0.5f, 12);
    ball.origin = shift + Eigen::Vector3d(2.0 * std::sin(i), 0.5, 2.0 * std::cos(i));
    add_mesh(scene, std::move(ball));
  }
  scene.model.lights = {point_light(shift + Eigen::Vector3d(1, 3, 1), 20.0f),
                        point_light(shift + Eigen::Vector3d(-3, 2, 0), 5.0f)};
  scene.model.lights[0].radius_m = 0.3;
  scene.sky.zenith = {0.2f, 0.3f, 0.5f};
  scene.sky.horizon = {0.4f, 0.4f, 0.4f};
  scene.info.start_eye = shift + Eigen::Vector3d(0, 1.6, 0);
  return scene;
}

TEST(Renderer, refuses_a_scene_without_triangles) {
  const auto renderer = Renderer::build(scene::Scene{}, 1, nullptr);
  ASSERT_FALSE(renderer.has_value());
  EXPECT_EQ(renderer.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(renderer.error().message(), testing::HasSubstr("neither triangles nor splats"));
}

TEST(Renderer, a_sphere_under_an_even_sky_shows_its_albedo) {
  scene::Scene scene = scene_of(sphere_mesh(1.0f, 32), {0.8f, 0.5f, 0.2f});
  scene.sky = {Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones(), Eigen::Vector3f::Ones()};
  PanoramaView view = view_from({0, 0, 3}, 32, 32, 0.1, -0.1);
  view.panorama.azimuth_span_rad = 0.2;  // Nothing but the sphere is visible.
  view.quality.samples = 4;
  const RadianceImage image = radiance_of(*built(std::move(scene)), view);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      EXPECT_NEAR(image.at(x, y)[0], 0.8f, 1e-4f);
      EXPECT_NEAR(image.at(x, y)[1], 0.5f, 1e-4f);
      EXPECT_NEAR(image.at(x, y)[2], 0.2f, 1e-4f);
    }
  }
}

TEST(Renderer, a_plane_under_a_point_light_follows_the_inverse_square_law) {
  scene::Scene scene = scene_of(square_mesh(20.0f));
  scene.model.lights = {point_light({0, 2, 0}, 10.0f)};
  const PanoramaView view = view_from({0, 1, 0}, 64, 16, -0.5, -2.0);
  const RadianceImage image = radiance_of(*built(std::move(scene)), view);
  for (int y = 0; y < 16; ++y) {
    // A pixel is the mean over its area, bounded by the law at its edges.
    const auto law = [&](double v) {
      const double out = 1.0 / -view.panorama.tan_elevation_at(v);
      const double r2 = out * out + 4.0;
      return 10.0 * 2.0 / std::sqrt(r2) / r2 / std::numbers::pi * 0.5;
    };
    for (int x = 0; x < 64; ++x) {
      EXPECT_GE(static_cast<double>(image.at(x, y)[0]), law(y) * 0.9999);
      EXPECT_LE(static_cast<double>(image.at(x, y)[0]), law(y + 1) * 1.0001);
    }
  }
}

TEST(Renderer, is_independent_of_tiling_and_threads) {
  PanoramaView view = view_from({0, 1.6, 0}, 100, 50, 0.8, -0.8);
  view.quality.samples = 3;
  view.seed = 0x123456789abcdefu;
  const auto one = built(busy_scene(), 1);
  const auto two = built(busy_scene(), 2);
  RgbImage reference;
  one->render(view, whole(view), &reference, nullptr);
  RgbImage other;
  two->render(view, whole(view), &other, nullptr);
  EXPECT_EQ(reference, other);
  for (const auto& [width, height] : {std::pair{7, 5}, std::pair{16, 16}, std::pair{33, 50}}) {
    for (int y = 0; y < 50; y += height) {
      for (int x = 0; x < 100; x += width) {
        const PixelRect rect{x, y, std::min(width, 100 - x), std::min(height, 50 - y)};
        RgbImage tile;
        two->render(view, rect, &tile, nullptr);
        for (int row = 0; row < rect.height; ++row) {
          ASSERT_TRUE(std::equal(tile.at(0, row), tile.at(0, row) + tile.row_values(), reference.at(x, y + row)));
        }
      }
    }
  }
}

/// A busy scene whose meshes have every kind of vertex data; one occurs twice.
scene::Scene scene_of_all_vertex_data() {
  scene::Scene scene = busy_scene();
  for (scene::Mesh& mesh : scene.model.meshes) {
    for (const auto& p : mesh.positions) {
      const Eigen::Vector3f n = Eigen::Vector3f(p[0], p[1] + 0.01f, p[2]).normalized();
      mesh.normals.push_back({n.x(), n.y(), n.z()});
      mesh.colours.push_back({static_cast<std::uint8_t>(100.0f + 100.0f * n.x()), 200, 90, 255});
    }
  }
  scene.model.materials[0].roughness = 0.3f;
  scene.model.instances.push_back(scene.model.instances.back());
  scene.model.instances.back().T_model_mesh.translate(Eigen::Vector3d(0, 1.2, 0));
  return scene;
}

TEST(Renderer, makes_the_same_picture_in_every_memory_mode) {
  PanoramaView view = view_from({0, 1.6, 0.5}, 96, 48, 1.0, -1.0);
  view.quality.samples = 4;
  view.quality.bounces = 2;
  RgbImage fast;
  std::size_t bytes = 0;
  for (const MemoryMode mode : kMemoryModes) {
    const auto renderer = Renderer::build(scene_of_all_vertex_data(), 2, nullptr, mode);
    ASSERT_TRUE(renderer.has_value());
    EXPECT_EQ((*renderer)->memory_mode(), mode);
    RgbImage image;
    (*renderer)->render(view, whole(view), &image, nullptr);
    const std::size_t takes = (*renderer)->bvh_bytes() + (*renderer)->shading_bytes();
    if (mode == MemoryMode::kFast) {
      fast = image;
    } else {
      EXPECT_TRUE(std::ranges::equal(image.data(), fast.data())) << name_of(mode);
      EXPECT_LT(takes, bytes) << name_of(mode);
    }
    bytes = takes;
  }
}

TEST(Renderer, the_seed_changes_only_the_noise) {
  const auto renderer = built(busy_scene());
  PanoramaView view = view_from({0, 1.6, 0}, 64, 32, 0.8, -0.8);
  view.quality.samples = 16;
  const RadianceImage first = radiance_of(*renderer, view);
  view.seed = 1;
  const RadianceImage second = radiance_of(*renderer, view);
  EXPECT_NE(first, second);
  EXPECT_NEAR(mean_of(first), mean_of(second), 0.01 * mean_of(first));
}

TEST(Renderer, gives_the_same_picture_far_from_the_origin) {
  const Eigen::Vector3d far(5e6, -3e5, 7e6);
  PanoramaView view = view_from({0, 1.6, 0}, 64, 32, 0.8, -0.8);
  const RadianceImage near_picture = radiance_of(*built(busy_scene()), view);
  view.eye += far;
  const RadianceImage far_picture = radiance_of(*built(busy_scene(far)), view);
  int different = 0;
  for (std::size_t i = 0; i < near_picture.data().size(); ++i) {
    if (std::abs(near_picture.data()[i] - far_picture.data()[i]) > 1e-3f) ++different;
  }
  EXPECT_LE(different, 6);  // A shift of a nanometre may move a silhouette across one or two samples.
}

TEST(Renderer, refuses_an_invalid_view_with_the_reason) {
  const PanoramaView good = view_from({0, 0, 0}, 64, 32, 1.0, -1.0);
  EXPECT_TRUE(check_view(good, whole(good)).has_value());
  EXPECT_TRUE(check_view(good, {64, 32, 0, 0}).has_value());
  const auto message = [](const PanoramaView& view, const PixelRect& rect) {
    const Status status = check_view(view, rect);
    return status ? std::string() : status.error().message();
  };
  PanoramaView view = good;
  view.eye.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message(view, whole(good)), testing::HasSubstr("eye"));
  view = good;
  view.heading_rad = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message(view, whole(good)), testing::HasSubstr("heading"));
  view = good;
  view.quality.samples = 0;
  EXPECT_THAT(message(view, whole(good)), testing::HasSubstr("samples"));
  view = good;
  view.panorama.azimuth_span_rad = 0.0;
  EXPECT_THAT(message(view, whole(good)), testing::HasSubstr("azimuth_span_rad"));
  for (const PixelRect& rect : {PixelRect{-1, 0, 4, 4}, PixelRect{61, 0, 4, 4}, PixelRect{0, 30, 4, 4},
                                PixelRect{0, 0, -1, 4}, PixelRect{0x7fffffff, 0, 0x7fffffff, 1}}) {
    EXPECT_THAT(message(good, rect), testing::HasSubstr("rectangle"));
  }
}

TEST(Renderer, a_cancelled_picture_stays_black) {
  const auto renderer = built(busy_scene());
  const PanoramaView view = view_from({0, 1.6, 0}, 64, 64, 0.8, -0.8);
  RgbImage image;
  std::atomic<int> asked = 0;
  const RenderCost cost = renderer->render(view, whole(view), &image, [&] { return ++asked > 0; });
  EXPECT_EQ(asked, 16);
  EXPECT_EQ(cost.rays, 0u);
  EXPECT_THAT(std::vector<std::uint8_t>(image.data().begin(), image.data().end()), testing::Each(0));
}

TEST(Renderer, reports_the_cost_of_a_picture) {
  const auto renderer = built(busy_scene());
  const PanoramaView view = view_from({0, 1.6, 0}, 64, 64, 0.8, -0.8);
  RgbImage image;
  const RenderCost cost = renderer->render(view, whole(view), &image, nullptr);
  EXPECT_GE(cost.rays, 64u * 64u);
  EXPECT_GT(cost.cpu_seconds, 0.0);
  EXPECT_GT(cost.wall_seconds, 0.0);
  EXPECT_GT(renderer->bvh_bytes(), 0u);
}

TEST(Renderer, reports_the_cost_of_each_cell_of_the_grid) {
  const auto renderer = built(busy_scene());
  PanoramaView view = view_from({0, 1.6, 0}, 72, 64, 0.8, -0.8);
  view.quality.samples = 4;
  const PixelRect rect{24, 16, 48, 20};  // Touches cells 1 to 4 of rows 1 and 2.
  RgbImage image;
  Film film;
  for (const RenderCost& cost :
       {renderer->render(view, rect, &image, nullptr), renderer->render_film(view, rect, true, &film, nullptr)}) {
    ASSERT_EQ(cost.cell_cpu_seconds.size(), 8u);
    EXPECT_THAT(cost.cell_cpu_seconds, testing::Each(testing::Gt(0.0f)));
    double sum = 0.0;
    for (const float seconds : cost.cell_cpu_seconds) sum += static_cast<double>(seconds);
    EXPECT_DOUBLE_EQ(cost.cpu_seconds, sum);
  }
  EXPECT_TRUE(renderer->render(view, {0, 0, 0, 0}, &image, nullptr).cell_cpu_seconds.empty());
}

TEST(Renderer, resumes_a_film_with_the_same_result_and_renders_no_cell_twice) {
  const auto renderer = built(busy_scene());
  PanoramaView view = view_from({0, 1.6, 0}, 80, 64, 0.8, -0.8);
  view.quality.samples = 3;
  for (const bool with_features : {false, true}) {
    Film once;
    const RenderCost all = renderer->render_film(view, whole(view), with_features, &once, nullptr);
    Film film(80, 64, with_features);
    std::uint64_t rays = 0;
    std::vector<int> rendered(all.cell_cpu_seconds.size());
    int calls = 0;
    for (bool stopped = true; stopped; ++calls) {
      std::atomic<int> asked = 0;
      stopped = false;
      const RenderCost cost = renderer->finish_film(view, whole(view), &film, [&] { return ++asked > 12; });
      rays += cost.rays;
      for (std::size_t i = 0; i < rendered.size(); ++i) rendered[i] += cost.cell_cpu_seconds[i] > 0.0f ? 1 : 0;
      for (const std::int32_t samples : film.samples.data()) stopped |= samples == 0;
      ASSERT_LT(calls, 20);
    }
    EXPECT_GT(calls, 1);
    EXPECT_THAT(rendered, testing::Each(1));
    EXPECT_EQ(rays, all.rays);
    EXPECT_EQ(film.sum, once.sum);
    EXPECT_EQ(film.square, once.square);
    EXPECT_EQ(film.samples, once.samples);
    EXPECT_EQ(film.features.normal, once.features.normal);
  }
}

TEST(Renderer, reports_the_progress_of_building_up_to_one) {
  std::vector<double> seen;
  const auto renderer = Renderer::build(busy_scene(), 2, [&](double fraction) { seen.push_back(fraction); });
  ASSERT_TRUE(renderer.has_value());
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 1.0);
}

}  // namespace
}  // namespace cyclorama::render
