// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/measured_lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cyclorama::calibration {
namespace {

MeasuredLens lens_with(double k1, double k2, double k3, double p1, double p2) {
  MeasuredLens lens = MeasuredLens::from_focal(1920, 1080, 1400.0);
  lens.values[MeasuredLens::kK1] = k1;
  lens.values[MeasuredLens::kK2] = k2;
  lens.values[MeasuredLens::kK3] = k3;
  lens.values[MeasuredLens::kP1] = p1;
  lens.values[MeasuredLens::kP2] = p2;
  return lens;
}

TEST(MeasuredLens, inverts_to_a_billionth_of_a_pixel_or_refuses) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int found = 0;
  for (int i = 0; i < 400; ++i) {
    const MeasuredLens lens =
        lens_with(0.6 * unit(random), 0.4 * unit(random), 0.1 * unit(random), 0.01 * unit(random), 0.01 * unit(random));
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector2d pixel(960.0 * (1.0 + unit(random)), 540.0 * (1.0 + unit(random)));
      const auto direction = lens.direction_at(pixel);
      if (!direction) continue;
      ++found;
      const auto back = lens.pixel_of(*direction);
      ASSERT_TRUE(back);
      EXPECT_LE((*back - pixel).norm(), 1e-9);
    }
  }
  EXPECT_GT(found, 6000);
}

TEST(MeasuredLens, refuses_pixels_past_the_turning_point_of_its_distortion) {
  const MeasuredLens lens = lens_with(-0.5, 0.0, 0.0, 0.0, 0.0);
  const double turning = std::sqrt(1.0 / 1.5);  // Maximum of r (1 - r²/2), which is 0.544.
  EXPECT_FALSE(lens.pixel_of({turning * 1.01, 0.0, 1.0}));
  EXPECT_TRUE(lens.pixel_of({turning * 0.99, 0.0, 1.0}));
  EXPECT_FALSE(lens.direction_at({960.0 + 1400.0 * 0.55, 540.0}));
  const auto near = lens.direction_at({960.0 + 1400.0 * 0.54, 540.0});
  ASSERT_TRUE(near);
  EXPECT_LT(near->x(), turning);
}

TEST(MeasuredLens, images_nothing_behind_it_and_no_nan) {
  const MeasuredLens lens = lens_with(0.0, 0.0, 0.0, 0.0, 0.0);
  EXPECT_FALSE(lens.pixel_of({0.1, 0.1, -1.0}));
  EXPECT_FALSE(lens.pixel_of({0.0, 0.0, 0.0}));
  EXPECT_FALSE(lens.direction_at({std::nan(""), 3.0}));
}

TEST(MeasuredLens, has_the_first_pixels_centre_at_one_half) {
  const MeasuredLens lens = lens_with(0.0, 0.0, 0.0, 0.0, 0.0);
  const auto middle = lens.pixel_of({0.0, 0.0, 2.0});
  ASSERT_TRUE(middle);
  EXPECT_EQ(*middle, Eigen::Vector2d(960.0, 540.0));  // The middle of a picture of even size is between pixels.
}

}  // namespace
}  // namespace cyclorama::calibration
