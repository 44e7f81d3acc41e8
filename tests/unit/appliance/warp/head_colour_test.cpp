// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/head_colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cyclorama::warp {
namespace {

TEST(ResponseCurve, is_the_inverse_of_the_device) {
  const ResponseCurve curve = ResponseCurve::power(2.4, 1024);
  for (double light = 0.001; light <= 1.0; light *= 1.1) {
    EXPECT_NEAR(std::pow(curve.code_of(light), 2.4), light, 1e-4 + 1e-3 * light);
  }
  EXPECT_EQ(curve.code_of(0.0), 0.0);
  EXPECT_EQ(curve.code_of(1.0), 1.0);
}

TEST(ResponseCurve, clips_light_that_the_device_cannot_emit) {
  const ResponseCurve curve{{0.25f, 0.5f}};
  EXPECT_EQ(curve.code_of(-3.0), 0.25);
  EXPECT_EQ(curve.code_of(std::numeric_limits<double>::quiet_NaN()), 0.25);
  EXPECT_EQ(curve.code_of(std::numeric_limits<double>::infinity()), 0.5);
  EXPECT_NEAR(curve.code_of(0.25), 0.375, 1e-9);  // Half way in the square root.
}

TEST(ResponseCurve, resampled_it_is_the_same_curve) {
  const ResponseCurve curve{{0.0f, 0.1f, 0.7f, 0.7f, 1.0f}};
  const ResponseCurve fine = curve.resampled(4097);
  for (int i = 0; i <= 1000; ++i) EXPECT_NEAR(fine.code_of(i / 1000.0), curve.code_of(i / 1000.0), 1e-6);
}

TEST(ResponseCurve, is_valid_with_two_or_more_codes_of_the_device) {
  EXPECT_TRUE(ResponseCurve::srgb(2).is_valid());
  EXPECT_FALSE(ResponseCurve{}.is_valid());
  EXPECT_FALSE(ResponseCurve{{0.5f}}.is_valid());
  EXPECT_FALSE((ResponseCurve{{0.0f, 1.5f}}).is_valid());
  EXPECT_FALSE((ResponseCurve{{0.0f, std::numeric_limits<float>::quiet_NaN()}}).is_valid());
}

TEST(HeadColour, without_settings_it_is_srgb) {
  const Eigen::Vector3d codes = codes_of({}, shone_light({}, {0.0, 0.2140411, 1.0}, 0.7));
  EXPECT_NEAR(codes[0], 0.0, 1e-9);
  EXPECT_NEAR(codes[1], 0.5, 1e-6);
  EXPECT_NEAR(codes[2], 1.0, 1e-9);
}

TEST(HeadColour, converts_primaries_and_adds_black_before_clipping) {
  HeadColour colour;
  colour.matrix = Eigen::Matrix3d{{1.0, -0.5, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.5, 0.5}};
  colour.black = {0.0, 0.1, 0.2};
  colour.black_lift = BlackLiftImage(1, 1, 0.5f);
  const Eigen::Vector3d light = shone_light(colour, {0.2, 0.6, 0.4}, 0.5);
  EXPECT_NEAR(light[0], -0.1, 1e-9);
  EXPECT_NEAR(light[1], 0.65, 1e-9);
  EXPECT_NEAR(light[2], 0.6, 1e-9);
  EXPECT_EQ(codes_of(colour, light)[0], 0.0);
}

}  // namespace
}  // namespace cyclorama::warp
