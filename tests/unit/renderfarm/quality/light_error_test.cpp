// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/light_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cyclorama::quality {
namespace {

using testing::HasSubstr;

RadianceImage constant(float value, int width = 5, int height = 4) { return {width, height, value}; }

TEST(LightError, is_zero_for_equal_pictures) {
  EXPECT_EQ(*mean_squared_error(constant(0.7f), constant(0.7f)), 0.0);
  EXPECT_EQ(*relative_squared_error(constant(0.7f), constant(0.7f)), 0.0);
}

TEST(LightError, has_the_closed_form_for_constant_pictures) {
  EXPECT_NEAR(*mean_squared_error(constant(3.0f), constant(1.0f)), 4.0, 1e-12);
  EXPECT_NEAR(*relative_squared_error(constant(3.0f), constant(1.0f)), 4.0 / 1.01, 1e-12);
  EXPECT_NEAR(*relative_squared_error(constant(1.0f), constant(3.0f)), 4.0 / 9.01, 1e-12);
  EXPECT_NEAR(*relative_squared_error(constant(1.0f), constant(0.0f)), 100.0, 1e-12);
  EXPECT_NEAR(*relative_squared_error(constant(1.0f), constant(0.0f), 0.5), 2.0, 1e-12);
}

TEST(LightError, is_the_mean_over_pixels_and_channels) {
  RadianceImage picture = constant(1.0f, 2, 1);
  picture.at(1, 0)[2] = 4.0f;
  EXPECT_NEAR(*mean_squared_error(picture, constant(1.0f, 2, 1)), 9.0 / 6.0, 1e-12);
  EXPECT_NEAR(*relative_squared_error(picture, constant(1.0f, 2, 1)), 9.0 / 1.01 / 6.0, 1e-12);
}

TEST(LightError, is_the_variance_of_noise) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0f, 0.1f);
  RadianceImage picture = constant(0.5f, 200, 200);
  for (float& value : picture.data()) value += noise(random);
  EXPECT_NEAR(*mean_squared_error(picture, constant(0.5f, 200, 200)), 0.01, 2e-4);
  EXPECT_NEAR(*relative_squared_error(picture, constant(0.5f, 200, 200)), 0.01 / 0.26, 1e-3);
}

TEST(LightError, a_relative_error_does_not_overflow_where_float_would) {
  EXPECT_NEAR(*relative_squared_error(constant(2e30f), constant(1e30f)), 1.0, 1e-6);
}

TEST(LightError, refuses_pictures_of_different_sizes_naming_both) {
  for (const auto& result : {mean_squared_error(constant(0, 5, 4), constant(0, 4, 5)),
                             relative_squared_error(constant(0, 5, 4), constant(0, 4, 5))}) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(result.error().message(), testing::AllOf(HasSubstr("5x4"), HasSubstr("4x5")));
  }
  EXPECT_FALSE(mean_squared_error({}, {}));
}

TEST(LightError, reports_the_position_of_nan_and_never_leaves_it_out) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    RadianceImage picture = constant(1.0f);
    picture.at(3, 2)[1] = bad;
    const auto result = relative_squared_error(picture, constant(1.0f));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code(), ErrorCode::kBadData);
    EXPECT_THAT(result.error().message(), testing::AllOf(HasSubstr("the picture"), HasSubstr("(3, 2)")));
    EXPECT_THAT(mean_squared_error(constant(1.0f), picture).error().message(), HasSubstr("the reference"));
  }
}

}  // namespace
}  // namespace cyclorama::quality
