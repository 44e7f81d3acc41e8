// SPDX-License-Identifier: Apache-2.0
#include "common/image/colour.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cyclorama {
namespace {

TEST(Colour, srgb_and_linear_are_inverse) {
  for (int i = 0; i <= 1000; ++i) {
    const float code = static_cast<float>(i) / 1000.0f;
    EXPECT_NEAR(linear_to_srgb(srgb_to_linear(code)), code, 2e-6f);
  }
}

TEST(Colour, every_8_bit_code_survives_the_conversion_to_light_and_back) {
  for (int code = 0; code < 256; ++code) {
    EXPECT_EQ(linear_to_srgb8(srgb_to_linear(static_cast<float>(code) / 255.0f)), code);
  }
}

TEST(Colour, the_table_gives_the_nearest_code) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (int i = 0; i < 200000; ++i) {
    const float u = uniform(random);
    const float linear = i % 2 == 0 ? u : u * u * u * u;  // In the dark, codes are close together.
    // Half a code, plus the formula's own rounding in float.
    EXPECT_LE(std::abs(static_cast<float>(linear_to_srgb8(linear)) - 255.0f * linear_to_srgb(linear)), 0.5002f) << linear;
  }
}

TEST(Colour, light_out_of_range_is_clipped) {
  EXPECT_EQ(linear_to_srgb8(-1.0f), 0);
  EXPECT_EQ(linear_to_srgb8(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(linear_to_srgb8(std::numeric_limits<float>::denorm_min()), 0);
  EXPECT_EQ(linear_to_srgb8(std::nextafter(1.0f, 0.0f)), 255);
  EXPECT_EQ(linear_to_srgb8(std::numeric_limits<float>::infinity()), 255);
}

}  // namespace
}  // namespace cyclorama
