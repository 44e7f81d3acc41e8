// SPDX-License-Identifier: Apache-2.0
// The inverse depth that a picture brings along, against distances computed by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/image/cropped.h"
#include "common/image/inverse_depth.h"
#include "renderfarm/render/renderer.h"
#include "tests/data_sets/mixed_room.h"

namespace cyclorama::render {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr double kBallRadius = 0.5;
const Eigen::Vector3d kBall(0.3, 1.2, -2.5);
const Eigen::Vector3d kEye(0.2, 1.6, 0.1);

std::unique_ptr<Renderer> built(scene::Scene scene) {
  auto renderer = Renderer::build(std::move(scene), 2, nullptr);
  EXPECT_TRUE(renderer.has_value()) << renderer.error().message();
  return *std::move(renderer);
}

Eigen::Affine3d moved(const Eigen::Vector3d& to) { return Eigen::Affine3d(Eigen::Translation3d(to)); }

/// A wall of that side in the plane z = `z`.
Eigen::Affine3d upright(double z) {
  return moved({0, 0, z}) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
}

/// A floor up to the horizon and a ball above it.
std::unique_ptr<Renderer> floor_and_ball() {
  scene::Scene scene = scene_of(square_mesh(4000.0f));
  add_mesh(scene, sphere_mesh(static_cast<float>(kBallRadius), 96), moved(kBall));
  return built(std::move(scene));
}

/// Returns the distances at which a ray enters and leaves a sphere; infinite if it misses.
std::pair<double, double> through_sphere(const EyeRay& ray, const Eigen::Vector3d& centre, double radius) {
  const Eigen::Vector3d to = ray.origin - centre;
  const double along = to.dot(ray.direction);
  const double root2 = along * along - to.squaredNorm() + radius * radius;
  if (root2 < 0.0) return {kNothing, kNothing};
  return {-along - std::sqrt(root2), -along + std::sqrt(root2)};
}

double to_floor_or_ball(const EyeRay& ray) {
  const double floor = ray.direction.y() < 0.0 ? -ray.origin.y() / ray.direction.y() : kNothing;
  const double ball = through_sphere(ray, kBall, kBallRadius).first;
  return std::min(floor, ball > 0.0 ? ball : kNothing);
}

PanoramaView view_of(const Projection& projection, int samples = 16) {
  PanoramaView view;
  view.eye = kEye;
  view.projection = projection;
  view.quality.samples = samples;
  view.quality.bounces = 0;
  view.depth = true;
  return view;
}

PixelRect all_of(const PanoramaView& view) { return {0, 0, view.picture().width_px(), view.picture().height_px()}; }

InverseDepthImage depth_of(const Renderer& renderer, const PanoramaView& view, const PixelRect& rect) {
  RgbImage picture;
  InverseDepthImage depth;
  renderer.render(view, rect, &picture, nullptr, &depth);
  return depth;
}
InverseDepthImage depth_of(const Renderer& renderer, const PanoramaView& view) {
  return depth_of(renderer, view, all_of(view));
}

int value_of(double distance_m) { return inverse_depth_of(static_cast<float>(distance_m)); }

/// Returns the distances at a grid of positions in a cell and up to `margin_px` around it, nearest first.
template <typename Distance>
std::vector<double> distances(const PanoramaView& view, int x, int y, double margin_px, const Distance& distance) {
  constexpr int kSteps = 12;
  std::vector<double> found;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const auto at = [&](int cell, int step, int size) {
        const double px = kDepthCellPx * cell - margin_px + (kDepthCellPx + 2.0 * margin_px) * step / kSteps;
        return std::clamp(px, 1e-6, size - 1e-6);
      };
      const auto ray = view.picture().ray_at({at(x, i, all_of(view).width), at(y, j, all_of(view).height)});
      found.push_back(ray ? distance(EyeRay{view.eye + ray->origin, ray->direction}) : kNothing);
    }
  }
  std::ranges::sort(found);
  return found;
}

/// Expects each cell to have the nearest distance, to a fifth of its area: it has 256 samples. Returns the number of
/// cells whose distances differ by more than a factor of 1.5.
template <typename Distance>
int expect_depth(const Renderer& renderer, const PanoramaView& view, const Distance& distance) {
  const InverseDepthImage depth = depth_of(renderer, view);
  const PixelRect cells = depth_cells(all_of(view));
  EXPECT_EQ(depth.width(), cells.width);
  EXPECT_EQ(depth.height(), cells.height);
  int edges = 0;
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const std::vector<double> inside = distances(view, x, y, 0.0, distance);
      const int value = *depth.at(x, y);
      // A thin part of a silhouette may lie between two positions.
      EXPECT_LE(value, value_of(distances(view, x, y, 0.5, distance).front()) + 1) << x << ", " << y;
      EXPECT_GE(value, value_of(inside[inside.size() / 5]) - 1) << x << ", " << y;
      if (inside[inside.size() / 5] * 1.5 < inside[inside.size() / 2]) ++edges;
    }
  }
  return edges;
}

std::vector<Projection> projections() {
  Viewing stereo;
  stereo.eyes = Eyes::kOverUnder;
  stereo.eye_distance_m = 0.4;
  stereo.screen_distance_m = 3.0;
  Viewing aside;
  aside.viewer_m = {0.3, -0.2, 0.4};
  aside.screen_distance_m = 3.0;
  const Panorama panorama{128, 64, 2.0, 0.5, -0.5};
  return {{panorama, {}},
          {Perspective{100, 68, -1.0, 0.8, 0.5, -0.6, -0.2}, {}},
          {Fisheye{72, 72, 3.0, -0.4}, {}},
          {Equirectangular{128, 64}, {}},
          {panorama, stereo},
          {Fisheye{64, 64, 2.6, -0.3}, stereo},
          {panorama, aside}};
}

class DepthOfEveryPicture : public testing::TestWithParam<int> {
 protected:
  [[nodiscard]] PanoramaView view() const { return view_of(projections()[static_cast<std::size_t>(GetParam())]); }
};

TEST_P(DepthOfEveryPicture, is_the_distance_along_the_ray_from_its_own_eye) {
  constexpr double kRadius = 3.0;
  const auto renderer = built(scene_of(sphere_mesh(kRadius, 128)));
  expect_depth(*renderer, view(),
               [](const EyeRay& ray) { return through_sphere(ray, Eigen::Vector3d::Zero(), kRadius).second; });
}

TEST_P(DepthOfEveryPicture, is_that_of_the_nearest_surface_at_silhouettes) {
  EXPECT_GT(expect_depth(*floor_and_ball(), view(), to_floor_or_ball), 5);
}

TEST_P(DepthOfEveryPicture, is_zero_where_the_eye_sees_nothing) {
  PanoramaView far = view();
  far.eye.z() = 1e6;
  EXPECT_THAT(depth_of(*built(scene_of(square_mesh(1.0f))), far).data(), testing::Each(0));
}

TEST_P(DepthOfEveryPicture, is_the_same_however_it_is_cut) {
  const auto renderer = built(mixed_room());
  PanoramaView cut = view();
  cut.eye = {0, 0, 0.5};
  cut.quality.samples = 2;
  cut.quality.bounces = 1;
  const InverseDepthImage whole = depth_of(*renderer, cut);
  EXPECT_GT(*std::ranges::max_element(whole.data()), *std::ranges::min_element(whole.data()));
  const int width = all_of(cut).width;
  const int height = all_of(cut).height;
  const auto expect_same = [&](const PixelRect& rect) {
    EXPECT_EQ(depth_of(*renderer, cut, rect), cropped(whole, depth_cells(rect))) << rect.x << ", " << rect.y;
  };
  for (int y = 0; y < height; y += 32) {
    for (int x = 0; x < width; x += 48) {
      expect_same({x, y, std::min(48, width - x), std::min(32, height - y)});
    }
  }
  for (const PixelRect& rect : {PixelRect{16, 16, 16, 16}, PixelRect{7, 13, 30, 26}, PixelRect{61, 50, 1, 1}}) {
    expect_same(rect);
  }
}

INSTANTIATE_TEST_SUITE_P(Projections, DepthOfEveryPicture, testing::Range(0, static_cast<int>(projections().size())));

TEST(Depth, leaves_the_picture_as_it_is) {
  const auto renderer = built(mixed_room());
  for (const float adaptive_error : {0.0f, 0.02f}) {
    PanoramaView view = room_view(3, 32);
    view.quality.adaptive_error = adaptive_error;
    RgbImage without, with;
    Film film_without, film_with;
    InverseDepthImage depth;
    const RenderCost cost_without = renderer->render(view, whole(view), &without, nullptr, &depth);
    EXPECT_TRUE(depth.empty());
    renderer->render_film(view, whole(view), true, &film_without, nullptr);
    view.depth = true;
    const RenderCost cost_with = renderer->render(view, whole(view), &with, nullptr, &depth);
    EXPECT_FALSE(depth.empty());
    renderer->render_film(view, whole(view), true, &film_with, nullptr);
    EXPECT_EQ(with, without);
    EXPECT_EQ(cost_with.rays, cost_without.rays);
    EXPECT_EQ(film_with.sum, film_without.sum);
    EXPECT_EQ(film_with.square, film_without.square);
    EXPECT_EQ(film_with.features.distance, film_without.features.distance);
    EXPECT_TRUE(film_without.depth.empty());
    EXPECT_EQ(film_with.depth, depth);
  }
}

TEST(Depth, has_the_mean_distance_of_the_features_where_a_cell_is_flat) {
  const auto renderer = built(scene_of(sphere_mesh(2.0f, 96)));
  PanoramaView view = view_from({0, 0, 0}, 64, 32, 0.5, -0.5);
  view.depth = true;
  Film film;
  renderer->render_film(view, whole(view), true, &film, nullptr);
  for (int y = 0; y < film.depth.height(); ++y) {
    for (int x = 0; x < film.depth.width(); ++x) {
      EXPECT_NEAR(*film.depth.at(x, y), value_of(static_cast<double>(*film.features.distance.at(4 * x, 4 * y))), 1);
    }
  }
}

constexpr double kFront = 1.1;
constexpr double kBack = 3.1;

/// The depth of the middle of a wall with something before it.
int depth_behind(const scene::Material& front, bool cut_out = false) {
  scene::Scene scene;
  scene.model.materials = {matte_material(Eigen::Vector3f::Ones()), front};
  scene.model.materials[1].alpha_mode = cut_out ? scene::AlphaMode::kMask : scene::AlphaMode::kOpaque;
  add_mesh(scene, square_mesh(20.0f, 0), upright(-kBack));
  add_mesh(scene, square_mesh(20.0f, 1), upright(-kFront));
  scene.sky.zenith = scene.sky.horizon = Eigen::Vector3f::Ones();
  PanoramaView view = view_of({Perspective{16, 16, -0.01, 0.01, 0.01, -0.01, 0.0}, {}}, 4);
  view.eye.setZero();
  view.quality.bounces = 3;
  const InverseDepthImage depth = depth_of(*built(std::move(scene)), view);
  EXPECT_THAT(depth.data(), testing::Each(*depth.at(0, 0)));
  return *depth.at(0, 0);
}

TEST(Depth, of_glass_and_mirrors_is_that_of_their_surface) {
  scene::Material glass = white_material(0.0f, 0.0f);
  glass.transmission = 1.0f;
  EXPECT_EQ(depth_behind(glass), value_of(kFront));
  glass.thickness = 0.1f;
  EXPECT_EQ(depth_behind(glass), value_of(kFront));
  EXPECT_EQ(depth_behind(white_material(0.0f, 1.0f)), value_of(kFront));
  EXPECT_EQ(depth_behind(matte_material(Eigen::Vector3f::Zero())), value_of(kFront));
}

TEST(Depth, ignores_what_is_cut_out) {
  scene::Material hole = matte_material(Eigen::Vector3f::Ones());
  hole.base_colour.w() = 0.1f;
  EXPECT_EQ(depth_behind(hole, true), value_of(kBack));
  hole.base_colour.w() = 0.9f;
  EXPECT_EQ(depth_behind(hole, true), value_of(kFront));
}

TEST(Depth, of_a_thing_smaller_than_a_pixel_is_seen_if_a_sample_meets_it) {
  scene::Scene scene;
  scene.model.materials.push_back(matte_material(Eigen::Vector3f::Ones()));
  add_mesh(scene, square_mesh(20.0f), upright(-8.0));
  scene::Mesh post = square_mesh(1.0f);
  for (auto& corner : post.positions) corner[0] *= 0.004f;  // Half a pixel wide.
  add_mesh(scene, std::move(post), upright(-1.0));
  PanoramaView view = view_of({Perspective{64, 64, -0.256, 0.256, 0.256, -0.256, 0.0}, {}});
  view.eye.setZero();
  const InverseDepthImage depth = depth_of(*built(std::move(scene)), view);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      const bool post_here = x == 7 || x == 8;
      EXPECT_NEAR(*depth.at(x, y), value_of(post_here ? 1.0 : 8.0), post_here ? 20 : 3) << x << ", " << y;
    }
  }
}

TEST(Depth, is_held_at_its_limits_from_a_millimetre_to_a_hundred_kilometres) {
  for (const double distance_m : {1e-3, 0.03, 0.1, 0.2, 1.0, 30.0, 800.0, 900.0, 1e4, 1e5}) {
    scene::Scene scene = scene_of(sphere_mesh(static_cast<float>(distance_m), 200));
    PanoramaView view = view_from({0, 0, 0}, 32, 16, 1.0, -1.0);
    view.depth = true;
    const InverseDepthImage depth = depth_of(*built(std::move(scene)), view);
    for (const std::uint16_t value : depth.data()) EXPECT_NEAR(value, value_of(distance_m), 1) << distance_m;
    const bool at_limit = distance_m < 0.1 || distance_m >= 900.0;
    if (at_limit) {
      EXPECT_THAT(depth.data(), testing::Each(value_of(distance_m))) << distance_m;
    }
  }
}

TEST(Depth, of_a_film_that_was_cancelled_is_complete_in_the_end) {
  const auto renderer = floor_and_ball();
  PanoramaView view = view_of({Panorama{96, 64, 2.0, 0.5, -0.5}, {}}, 2);
  Film once;
  renderer->render_film(view, all_of(view), false, &once, nullptr);
  Film film;
  renderer->render_film(view, all_of(view), false, &film, [] { return true; });
  EXPECT_THAT(film.depth.data(), testing::Each(0));
  for (bool stopped = true; stopped;) {
    std::atomic<int> calls = 0;
    stopped = false;
    renderer->finish_film(view, all_of(view), &film, [&] { return ++calls > 7; });
    for (const std::int32_t samples : film.samples.data()) stopped |= samples == 0;
  }
  EXPECT_EQ(film.depth, once.depth);
}

TEST(Depth, of_added_films_is_the_nearest_of_both) {
  const auto renderer = floor_and_ball();
  PanoramaView view = view_of({Panorama{96, 64, 2.0, 0.5, -0.5}, {}}, 16);
  Film once;
  renderer->render_film(view, all_of(view), false, &once, nullptr);
  view.quality.sequence = 16;
  view.quality.samples = 6;
  Film sum, rest;
  renderer->render_film(view, all_of(view), false, &sum, nullptr);
  view.quality.first_sample = 6;
  view.quality.samples = 10;
  renderer->render_film(view, all_of(view), false, &rest, nullptr);
  EXPECT_NE(sum.depth, once.depth);
  EXPECT_NE(rest.depth, once.depth);
  sum.add(rest);
  EXPECT_EQ(sum.depth, once.depth);
}

}  // namespace
}  // namespace cyclorama::render
