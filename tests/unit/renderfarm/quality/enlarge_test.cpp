// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/enlarge.h"

#include <gtest/gtest.h>

namespace cyclorama::quality {
namespace {

TEST(Enlarged, a_picture_of_that_size_is_unchanged) {
  RadianceImage light(5, 3, 0.1f);
  light.at(2, 1)[0] = 7.0f;
  EXPECT_EQ(enlarged(light, 5, 3), light);
  RgbImage codes(5, 3, 200);
  EXPECT_EQ(enlarged(codes, 5, 3), codes);
}

TEST(Enlarged, a_ramp_stays_a_ramp_between_the_outermost_centres) {
  RadianceImage ramp(4, 1);
  for (int x = 0; x < 4; ++x) ramp.at(x, 0)[1] = static_cast<float>(x) + 0.5f;
  const RadianceImage large = enlarged(ramp, 12, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 2; x < 10; ++x) EXPECT_NEAR(large.at(x, y)[1], (static_cast<float>(x) + 0.5f) / 3.0f, 1e-5f) << x;
    EXPECT_EQ(large.at(0, y)[1], 0.5f);
    EXPECT_EQ(large.at(11, y)[1], 3.5f);
    EXPECT_EQ(large.at(5, y)[0], 0.0f);
  }
}

TEST(Enlarged, any_ratio_of_sizes_keeps_the_mean) {
  RadianceImage picture(7, 5);
  for (std::size_t i = 0; i < picture.data().size(); ++i) picture.data()[i] = static_cast<float>(i % 11);
  const RadianceImage large = enlarged(picture, 70, 50);
  double small_sum = 0.0;
  double large_sum = 0.0;
  for (const float value : picture.data()) small_sum += static_cast<double>(value);
  for (const float value : large.data()) large_sum += static_cast<double>(value);
  EXPECT_NEAR(large_sum / 100.0, small_sum, 0.01 * small_sum);
}

TEST(Enlarged, codes_are_mixed_as_light) {
  RgbImage pair(2, 1);
  for (int c = 0; c < 3; ++c) pair.at(1, 0)[c] = 255;
  const RgbImage large = enlarged(pair, 6, 1);
  EXPECT_EQ(large.at(0, 0)[0], 0);
  EXPECT_EQ(large.at(5, 0)[0], 255);
  EXPECT_EQ(large.at(2, 0)[0], 156);  // A third of white's light.
}

}  // namespace
}  // namespace cyclorama::quality
