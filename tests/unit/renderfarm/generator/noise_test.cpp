// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/noise.h"

#include <gtest/gtest.h>

#include <random>

namespace cyclorama::generator {
namespace {

class Noise : public testing::Test {
 protected:
  Vec3 place() { return {coordinate_(random_), coordinate_(random_), coordinate_(random_)}; }

  std::mt19937 random_{7};
  std::uniform_real_distribution<float> coordinate_{-40.0f, 40.0f};
};

TEST_F(Noise, stays_near_minus_one_to_one_with_a_mean_near_zero) {
  double sum = 0.0;
  constexpr int kSamples = 20'000;
  for (int i = 0; i < kSamples; ++i) {
    const float value = noise(place(), 3u);
    ASSERT_LE(std::abs(value), 1.2f);
    ASSERT_LE(std::abs(fractal_noise(place(), 5, 3u)), 1.7f);
    sum += static_cast<double>(value);
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 0.02);
}

TEST_F(Noise, is_continuous) {
  for (int i = 0; i < 5'000; ++i) {
    const Vec3 p = place();
    const Vec3 q = p + Vec3::Constant(1e-3f);
    EXPECT_NEAR(noise(p, 1u), noise(q, 1u), 0.02f);
    EXPECT_NEAR(fractal_noise(p, 4, 1u), fractal_noise(q, 4, 1u), 0.06f);
  }
}

TEST_F(Noise, is_zero_on_the_lattice_and_differs_between_seeds) {
  EXPECT_EQ(noise({3.0f, -2.0f, 5.0f}, 1u), 0.0f);
  int differ = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = place();
    if (noise(p, 1u) != noise(p, 2u)) ++differ;
  }
  EXPECT_GT(differ, 95);
}

TEST_F(Noise, marks_and_cracks_are_fractions) {
  float max_marks = 0.0f;
  float max_crack = 0.0f;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = place();
    const float marks = chisel_marks({p.x(), p.y()}, 5u);
    const float crack = crack_lines(p, 5u);
    ASSERT_TRUE(marks >= 0.0f && marks <= 1.0f) << marks;
    ASSERT_TRUE(crack >= 0.0f && crack <= 1.0f) << crack;
    max_marks = std::max(max_marks, marks);
    max_crack = std::max(max_crack, crack);
  }
  EXPECT_GT(max_marks, 0.8f);
  EXPECT_GT(max_crack, 0.5f);  // There are some cracks.
}

TEST(RandomUnit, is_spread_evenly_below_one) {
  int low = 0;
  for (int i = 0; i < 10'000; ++i) {
    const float value = random_unit(i, -3 * i, 11u);
    ASSERT_TRUE(value >= 0.0f && value < 1.0f);
    if (value < 0.5f) ++low;
  }
  EXPECT_NEAR(low, 5'000, 250);
}

}  // namespace
}  // namespace cyclorama::generator
