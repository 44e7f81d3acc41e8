// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/denoise/gain.h"

#include <gtest/gtest.h>

#include <random>

namespace cyclorama::denoise {
namespace {

/// Even light of 1, from one sample with normal noise of deviation 0.5.
std::vector<render::Film> noisy_films(int count) {
  std::mt19937 generator(3);
  std::normal_distribution<float> noise(1.0f, 0.5f);
  std::vector<render::Film> films(static_cast<std::size_t>(count), render::Film(64, 64, false));
  for (render::Film& film : films) {
    for (float& value : film.sum.data()) value = noise(generator);
    for (std::int32_t& samples : film.samples.data()) samples = 1;
  }
  return films;
}

constexpr double kWeight = 1.0 / 1.01;

TEST(DenoiseGain, distinguishes_bias_from_noise) {
  // Halves the noise and adds a tenth.
  const auto denoise = [](const render::Film& film) {
    RadianceImage picture = film.mean();
    for (float& value : picture.data()) value = 1.1f + 0.5f * (value - 1.0f);
    return picture;
  };
  const auto gain = measure_gain(RadianceImage(64, 64, 1.0f), noisy_films(6), denoise);
  ASSERT_TRUE(gain);
  EXPECT_NEAR((*gain).mse_before, 0.25 * kWeight, 0.005);
  EXPECT_NEAR((*gain).variance_after, 0.0625 * kWeight, 0.0015);
  EXPECT_NEAR((*gain).bias2, 0.01 * kWeight, 0.001);
  EXPECT_NEAR((*gain).mse_after, (*gain).bias2 + (*gain).variance_after, 1e-9);
}

TEST(DenoiseGain, finds_no_bias_where_there_is_none) {
  const auto gain =
      measure_gain(RadianceImage(64, 64, 1.0f), noisy_films(4), [](const render::Film& film) { return film.mean(); });
  ASSERT_TRUE(gain);
  EXPECT_NEAR((*gain).gain(), 1.0, 1e-9);
  EXPECT_NEAR((*gain).bias_share(), 0.0, 0.01);
}

TEST(DenoiseGain, refuses_pictures_that_cannot_be_measured) {
  const auto as_it_is = [](const render::Film& film) { return film.mean(); };
  EXPECT_EQ(measure_gain(RadianceImage(64, 64), noisy_films(1), as_it_is).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(measure_gain(RadianceImage(64, 63), noisy_films(2), as_it_is).error().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama::denoise
