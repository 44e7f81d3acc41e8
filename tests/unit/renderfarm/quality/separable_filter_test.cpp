// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/separable_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cyclorama::quality {
namespace {

using Plane = Image<double, 1>;

Plane with_a_point(int width, int height, int x, int y) {
  Plane plane(width, height);
  *plane.at(x, y) = 1.0;
  return plane;
}

TEST(SeparableFilter, a_point_becomes_the_mirrored_kernel) {
  const Plane result = filtered(with_a_point(7, 7, 3, 3), {1, 2, 4}, {10, 20, 30});
  EXPECT_EQ(*result.at(4, 3), 20.0);  // The pixel right of the point has it on its left.
  EXPECT_EQ(*result.at(2, 3), 80.0);
  EXPECT_EQ(*result.at(3, 4), 20.0);
  EXPECT_EQ(*result.at(2, 2), 120.0);
  EXPECT_EQ(*result.at(5, 3), 0.0);
}

TEST(SeparableFilter, a_constant_is_unchanged_up_to_the_border) {
  const Kernel kernel = normalized(gaussian(9, 2.0));
  const Plane result = filtered(Plane(5, 3, 2.5), kernel, kernel);
  for (const double value : result.data()) EXPECT_NEAR(value, 2.5, 1e-14);
}

TEST(SeparableFilter, the_last_pixel_is_repeated_beyond_the_border) {
  Plane plane(3, 1);
  *plane.at(2, 0) = 1.0;
  EXPECT_EQ(*filtered_along_rows(plane, {1, 1, 1}).at(2, 0), 2.0);
  EXPECT_EQ(*filtered_along_columns(plane, {1, 1, 1}).at(2, 0), 3.0);
}

TEST(SeparableFilter, float_and_double_agree) {
  Image<float, 1> single(20, 10);
  Plane twice(20, 10);
  for (std::size_t i = 0; i < 200; ++i) {
    twice.data()[i] = std::sin(static_cast<double>(i));
    single.data()[i] = static_cast<float>(twice.data()[i]);
  }
  const Kernel kernel = normalized(gaussian(4, 1.5));
  const Image<float, 1> a = filtered(single, kernel, kernel);
  const Plane b = filtered(twice, kernel, kernel);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_NEAR(static_cast<double>(a.data()[i]), b.data()[i], 1e-6);
}

TEST(SeparableFilter, an_empty_picture_stays_empty) { EXPECT_TRUE(filtered(Plane(), {1}, {1}).empty()); }

}  // namespace
}  // namespace cyclorama::quality
