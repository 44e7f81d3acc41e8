// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/split_reference.h"

#include <gtest/gtest.h>

#include <random>

namespace cyclorama::quality {
namespace {

RadianceImage noisy(float value, float noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> scatter(value, noise);
  RadianceImage image(64, 64);
  for (float& pixel : image.data()) pixel = scatter(random);
  return image;
}

TEST(SplitReference, keeps_its_own_noise_out_of_the_error) {
  const SplitReference reference{noisy(1.0f, 0.05f, 1), noisy(1.0f, 0.05f, 2)};
  // Off by 5 %, as much as the noise.
  const double error = 0.05 * 0.05 / 1.01;
  EXPECT_NEAR(unbiased_relmse(RadianceImage(64, 64, 1.05f), reference), error, 0.2 * error);
  EXPECT_NEAR(unbiased_relmse(RadianceImage(64, 64, 1.0f), reference), 0.0, 0.2 * error);
}

TEST(SplitReference, knows_the_error_of_a_half) {
  const SplitReference reference{noisy(1.0f, 0.2f, 1), noisy(1.0f, 0.2f, 2)};
  EXPECT_NEAR(half_relmse(reference), 0.2 * 0.2 / 1.01, 0.002);
}

TEST(SplitReference, averages_whole_blocks) {
  RadianceImage picture(5, 4, 0.0f);
  picture.at(0, 0)[1] = 8.0f;
  picture.at(3, 3)[2] = 4.0f;
  picture.at(4, 0)[0] = 100.0f;  // In no whole block.
  const RadianceImage blocks = block_means(picture, 2);
  EXPECT_EQ(blocks.width(), 2);
  EXPECT_EQ(blocks.height(), 2);
  EXPECT_EQ(blocks.at(0, 0)[1], 2.0f);
  EXPECT_EQ(blocks.at(1, 1)[2], 1.0f);
  EXPECT_EQ(blocks.at(1, 0)[0], 0.0f);
  const SplitReference halves = block_means(SplitReference{picture, RadianceImage(5, 4, 1.0f)}, 2);
  EXPECT_EQ(mean_of(halves).at(0, 0)[1], 1.5f);
}

}  // namespace
}  // namespace cyclorama::quality
