// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/blend_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/data_sets/demo_room.h"

namespace cyclorama::warp {
namespace {

/// Interpolates the factor between four pixel centres; empty if one of them is outside the picture.
std::optional<double> bilinear(const MaskImage& mask, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x() - 0.5));
  const int y = static_cast<int>(std::floor(pixel.y() - 0.5));
  if (x < 0 || y < 0 || x + 1 >= mask.width() || y + 1 >= mask.height()) return std::nullopt;
  const double fx = pixel.x() - 0.5 - x;
  const double fy = pixel.y() - 0.5 - y;
  const auto at = [&](int i, int j) { return static_cast<double>(*mask.at(x + i, y + j)); };
  return (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) + fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
}

TEST(BlendMask, the_sum_of_all_masks_is_one_on_every_wall_point) {
  const Installation room = demo_room();
  const CylinderWall& wall = cylinder_of(room);
  const std::vector<ProjectorMap> maps = projector_maps(room);
  const std::vector<MaskImage> masks = make_blend_masks(maps);
  std::mt19937 random(3);
  double worst = 0.0;
  int shared = 0;
  for (int n = 0; n < 20000; ++n) {
    // A pixel's width inside the wall's edge, since the masks are cut off beyond it.
    const double arc = std::uniform_real_distribution(-0.5, 0.5)(random) * (wall.arc_rad - 0.02);
    const double height = std::uniform_real_distribution(wall.bottom_m + 0.02, wall.top_m - 0.02)(random);
    const Point<frame::Room> point = wall.point_at(arc, height);
    double sum = 0.0;
    int lighting = 0;
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto pixel = maps[i].pixel_lighting(point);
      const auto factor = pixel ? bilinear(masks[i], *pixel) : std::nullopt;
      if (factor) ++lighting;
      sum += factor.value_or(0.0);
    }
    shared += lighting > 1 ? 1 : 0;
    worst = std::max(worst, std::abs(sum - 1.0));
  }
  EXPECT_LE(worst, 0.005);
  EXPECT_GT(shared, 1000);
  std::printf("worst sum of 20000 wall points differs from 1 by %.5f; %d points are shared\n", worst, shared);
}

TEST(BlendMask, is_zero_exactly_where_the_pixel_misses_the_wall) {
  const std::vector<ProjectorMap> maps = projector_maps(demo_room());
  const std::vector<MaskImage> masks = make_blend_masks(maps);
  int dark = 0;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    for (int y = 0; y < masks[i].height(); ++y) {
      for (int x = 0; x < masks[i].width(); ++x) {
        const float factor = *masks[i].at(x, y);
        ASSERT_TRUE(factor >= 0.0f && factor <= 1.0f);
        const bool on_wall = maps[i].wall_point_of({x + 0.5, y + 0.5}).has_value();
        ASSERT_EQ(factor > 0.0f, on_wall) << i << " " << x << " " << y;
        dark += on_wall ? 0 : 1;
      }
    }
  }
  EXPECT_GT(dark, 1000);
}

TEST(BlendMask, is_continuous_inside_the_wall) {
  const Installation room = demo_room();
  const std::vector<ProjectorMap> maps = projector_maps(room);
  constexpr int kSteps = 2000;
  for (const double height : {0.45, 1.0, 1.65, 2.3, 2.85}) {
    std::vector<double> previous;
    for (int i = 0; i <= kSteps; ++i) {
      const double arc = cylinder_of(room).arc_rad * (static_cast<double>(i) / kSteps - 0.5);
      const std::vector<double> weights = blend_weights(maps, cylinder_of(room).point_at(arc, height));
      for (std::size_t k = 0; k < previous.size(); ++k) ASSERT_LT(std::abs(weights[k] - previous[k]), 0.03);
      previous = weights;
    }
  }
}

TEST(BlendMask, weights_are_zero_where_no_projector_lights_the_wall) {
  Installation room = demo_room();
  room.projectors.resize(1);
  const std::vector<ProjectorMap> maps = projector_maps(room);
  EXPECT_THAT(blend_weights(maps, cylinder_of(room).point_at(1.0, 1.5)), ::testing::ElementsAre(0.0));
  EXPECT_THAT(blend_weights(maps, cylinder_of(room).point_at(-1.0, 1.5)), ::testing::ElementsAre(1.0));
}

TEST(DemoRoom, is_lit_everywhere_and_its_pictures_overlap_by_a_sixth) {
  Installation room = demo_room();
  EXPECT_EQ(unlit_fraction(room), 0.0);
  const std::vector<ProjectorMap> maps = projector_maps(room);
  int middle = 0;
  int left_too = 0;
  for (int i = 0; i <= 10000; ++i) {
    const Point<frame::Room> point = cylinder_of(room).point_at(cylinder_of(room).arc_rad * (i / 10000.0 - 0.5), 1.65);
    if (!maps[1].pixel_lighting(point)) continue;
    ++middle;
    left_too += maps[0].pixel_lighting(point) ? 1 : 0;
  }
  EXPECT_GT(left_too, 0.15 * middle);
  EXPECT_LT(left_too, 0.20 * middle);
  room.projectors.erase(room.projectors.begin() + 1);
  EXPECT_GT(unlit_fraction(room), 0.2);
}

}  // namespace
}  // namespace cyclorama::warp
