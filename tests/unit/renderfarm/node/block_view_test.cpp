// SPDX-License-Identifier: Apache-2.0
// Views for one eye and for two, from the wire message to camera rays.
#include "renderfarm/node/block_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/wire/convert.h"
#include "renderfarm/render/camera.h"
#include "tests/data_sets/simple_scenes.h"

namespace cyclorama::node {
namespace {

constexpr double kEyes_m = 0.063;
constexpr double kWall_m = 3.0;

wire::RenderBlock whole_block(const Projection& picture) {
  wire::RenderBlock block;
  block.set_width_px(static_cast<std::uint32_t>(picture.width_px()));
  block.set_height_px(static_cast<std::uint32_t>(picture.height_px()));
  wire::View& view = *block.mutable_view();
  view.set_number(1);
  view.set_samples(4);
  view.set_jpeg_quality(85);
  to_wire(picture, view.mutable_panorama());
  return block;
}

Projection for_two(const PictureShape& shape) { return {shape, {Eyes::kOverUnder, kEyes_m, kWall_m}}; }

TEST(BlockView, of_one_eye_is_the_panorama_itself) {
  const Panorama panorama{64, 32, 1.0, 0.4, -0.4};
  const auto view = view_of(whole_block({panorama, {}}));
  ASSERT_TRUE(view) << view.error().message();
  EXPECT_FALSE(view->projection) << "as before there were others";
  EXPECT_EQ(view->panorama, panorama);
}

TEST(BlockView, has_the_levels_of_the_groups_of_lamps_and_leaves_others_as_they_are) {
  wire::RenderBlock block = whole_block({Panorama{64, 32, 1.0, 0.4, -0.4}, {}});
  EXPECT_EQ(view_of(block)->lamps, scene::kAuthoredLamps);
  for (int group = 0; group < 7; ++group) block.mutable_view()->add_lamp_levels(0.5f * static_cast<float>(group));
  EXPECT_EQ(view_of(block)->lamps, (scene::LampLevels{1.0f, 0.0f, 0.5f, 1.0f, 1.5f, 2.0f, 2.5f, 3.0f}));
}

TEST(BlockView, of_two_eyes_has_rays_that_start_at_the_eyes) {
  const Panorama round{640, 320, 2.0, 0.5, -0.5};
  const Perspective flat{640, 320, -1.0, 1.0, 0.5, -0.5, 0.0};
  for (const PictureShape& shape : {PictureShape(round), PictureShape(flat)}) {
    const auto view = view_of(whole_block(for_two(shape)));
    ASSERT_TRUE(view) << view.error().message();
    const Projection picture = view->picture();
    ASSERT_EQ(picture.height_px(), 640);
    const render::RayCamera camera(picture, 0.0);
    for (const int row : {0, 1, 160, 318, 319}) {
      for (const int column : {0, 100, 320, 639}) {
        const Eigen::Vector3d on_screen = kWall_m * *direction_at(shape, {column + 0.5, row + 0.5});
        // The eyes lie across the column's direction for a round wall, and parallel to a flat wall.
        const double azimuth = shape.index() == 0 ? round.azimuth_at(column + 0.5) : 0.0;
        const Eigen::Vector3d right(std::cos(azimuth), 0.0, std::sin(azimuth));
        for (const int eye : {0, 1}) {
          render::CameraRay ray;
          ASSERT_TRUE(camera.ray(static_cast<float>(column) + 0.5f, static_cast<float>(row + 320 * eye) + 0.5f, &ray));
          const Eigen::Vector3d place = (eye == 0 ? -0.5 : 0.5) * kEyes_m * right;
          EXPECT_LT((ray.origin.cast<double>() - place).norm(), 1e-8) << row << ", " << column;
          EXPECT_LT((ray.direction.cast<double>() - (on_screen - place).normalized()).norm(), 1e-6);
        }
      }
    }
  }
}

TEST(BlockView, of_two_eyes_is_refused_if_no_cut_separates_them) {
  wire::RenderBlock block = whole_block(for_two(Panorama{64, 32, 1.0, 0.4, -0.4}));
  block.mutable_view()->mutable_panorama()->set_height_px(80);
  EXPECT_FALSE(view_of(block));
  block.mutable_view()->mutable_panorama()->set_height_px(32);
  EXPECT_FALSE(view_of(block)) << "the block is larger than that";
}

/// Returns the mean column of the light in the rows of one eye.
double column_of_light(const RadianceImage& image, int top, int rows) {
  double sum = 0.0;
  double moment = 0.0;
  for (int y = top; y < top + rows; ++y) {
    for (int x = 0; x < image.width(); ++x) {
      sum += static_cast<double>(image.at(x, y)[1]);
      moment += (x + 0.5) * static_cast<double>(image.at(x, y)[1]);
    }
  }
  return sum > 0.0 ? moment / sum : -1.0;
}

TEST(BlockView, shows_near_objects_with_crossed_disparity_and_no_hole_at_the_seam) {
  constexpr int kHeight = 96;
  const Panorama panorama{512, kHeight, 0.512, 0.048, -0.048};  // One milliradian per pixel.
  for (const double distance_m : {1.5, 3.0, 12.0}) {
    // A small ball ahead.
    scene::Scene scene = scene_of(sphere_mesh(static_cast<float>(0.01 * distance_m), 24));
    scene.ambient = Eigen::Vector3f::Ones();
    auto renderer = render::Renderer::build(std::move(scene), 1, nullptr);
    ASSERT_TRUE(renderer) << renderer.error().message();
    wire::RenderBlock block = whole_block(for_two(panorama));
    block.mutable_view()->mutable_eye_m()->set_z(distance_m);
    const auto view = view_of(block);
    ASSERT_TRUE(view) << view.error().message();
    render::Film film;
    (*renderer)->render_film(*view, {0, 0, 512, 2 * kHeight}, false, &film, nullptr);
    for (int y = 0; y < 2 * kHeight; ++y) {
      for (int x = 0; x < 512; ++x) ASSERT_EQ(*film.samples.at(x, y), 4) << x << ", " << y;
    }
    const RadianceImage light = film.mean();
    const double left = column_of_light(light, 0, kHeight);
    const double right = column_of_light(light, kHeight, kHeight);
    // The right eye sees a ball in front of the wall further left.
    const double apart_rad = kEyes_m * (1.0 / kWall_m - 1.0 / distance_m);
    EXPECT_NEAR(right - left, 1000.0 * apart_rad, 0.3) << distance_m;
    EXPECT_NEAR(0.5 * (left + right), 256.0, 0.3) << distance_m;
  }
}

}  // namespace
}  // namespace cyclorama::node
