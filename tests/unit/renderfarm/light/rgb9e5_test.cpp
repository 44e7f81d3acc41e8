// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/light/rgb9e5.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace cyclorama::light {
namespace {

using Eigen::Vector3f;

TEST(Rgb9e5, keeps_each_channel_within_a_512th_of_the_largest) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> part(0.0f, 1.0f);
  for (int exponent = -20; exponent <= 15; ++exponent) {
    for (int i = 0; i < 200; ++i) {
      const Vector3f colour = Vector3f(part(random), part(random), part(random)) * std::ldexp(1.0f, exponent);
      const Vector3f again = from_rgb9e5(to_rgb9e5(colour));
      const float allowed = std::max(colour.maxCoeff() / 512.0f, kMinRgb9e5);
      EXPECT_LE((again - colour).cwiseAbs().maxCoeff(), allowed) << "2^" << exponent;
    }
  }
}

TEST(Rgb9e5, is_exact_for_black_and_for_its_own_values) {
  EXPECT_EQ(from_rgb9e5(to_rgb9e5(Vector3f::Zero())), Vector3f(Vector3f::Zero()));
  for (const float value : {kMinRgb9e5, 0.5f, 1.0f, 510.0f, kMaxRgb9e5}) {
    EXPECT_EQ(from_rgb9e5(to_rgb9e5(Vector3f::Constant(value))), Vector3f(Vector3f::Constant(value)));
  }
}

TEST(Rgb9e5, rounds_up_across_a_power_of_two) {
  // 511.7 / 512 has no mantissa of 9 bits, so the exponent grows.
  EXPECT_EQ(from_rgb9e5(to_rgb9e5(Vector3f::Constant(511.7f / 512.0f))), Vector3f(Vector3f::Ones()));
}

TEST(Rgb9e5, has_no_bias_with_random_rounding) {
  const Vector3f colour(0.7123f, 0.3331f, 0.0517f);
  Vector3f sum = Vector3f::Zero();
  constexpr int kCount = 4096;
  for (int i = 0; i < kCount; ++i) {
    sum += from_rgb9e5(to_rgb9e5(colour, (static_cast<float>(i) + 0.5f) / kCount));
  }
  EXPECT_LT((sum / kCount - colour).cwiseAbs().maxCoeff(), 1e-6f);
}

TEST(Rgb9e5, clamps_what_is_negative_too_bright_or_not_a_number) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(from_rgb9e5(to_rgb9e5({-1.0f, nan, 1.0f})), Vector3f(0.0f, 0.0f, 1.0f));
  EXPECT_EQ(from_rgb9e5(to_rgb9e5({infinity, 1e9f, 0.0f})), Vector3f(kMaxRgb9e5, kMaxRgb9e5, 0.0f));
}

}  // namespace
}  // namespace cyclorama::light
