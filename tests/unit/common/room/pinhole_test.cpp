// SPDX-License-Identifier: Apache-2.0
#include "common/room/pinhole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace cyclorama {
namespace {

TEST(Pinhole, a_field_of_view_spans_the_whole_width) {
  const Pinhole lens = Pinhole::from_field_of_view(1920, 1080, 0.5 * std::numbers::pi);
  EXPECT_NEAR(lens.focal_px, 960.0, 1e-9);
  EXPECT_NEAR(lens.direction_at(0.0, 540.0).x(), -1.0, 1e-12);
  EXPECT_NEAR(lens.direction_at(1920.0, 540.0).x(), 1.0, 1e-12);
  EXPECT_GT(lens.direction_at(960.0, 1080.0).y(), 0.0);  // y points down.
}

TEST(Pinhole, pixel_of_is_the_inverse_of_direction_at) {
  Pinhole lens = Pinhole::from_field_of_view(1920, 1200, 1.0);
  lens.centre_v_px = 100.0;
  for (double u = -100.0; u < 2100.0; u += 97.0) {
    for (double v = -100.0; v < 1300.0; v += 83.0) {
      const auto pixel = lens.pixel_of(7.5 * lens.direction_at(u, v));
      ASSERT_TRUE(pixel.has_value());
      EXPECT_LT((*pixel - Eigen::Vector2d(u, v)).norm(), 1e-9);
      EXPECT_EQ(lens.contains(*pixel), u >= 0.0 && u <= 1920.0 && v >= 0.0 && v <= 1200.0);
    }
  }
}

TEST(Pinhole, images_nothing_behind_it) {
  const Pinhole lens = Pinhole::from_field_of_view(64, 64, 1.0);
  EXPECT_FALSE(lens.pixel_of({0, 0, -1}).has_value());
  EXPECT_FALSE(lens.pixel_of({1, 0, 0}).has_value());
  EXPECT_FALSE(lens.pixel_of({0, 0, std::nan("")}).has_value());
}

}  // namespace
}  // namespace cyclorama
