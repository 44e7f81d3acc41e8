// SPDX-License-Identifier: Apache-2.0
/// The test on which other tests rely must be able to fail, and must not raise false alarms.
#include "tests/support/z_test.h"

#include <gtest/gtest.h>

#include <random>

namespace cyclorama::render {
namespace {

constexpr int kWidth = 16;
constexpr int kHeight = 12;

/// Noise around a mean that grows from pixel to pixel; the first pixel has no noise and is always right.
Film noise(int samples, unsigned seed, float brighter_everywhere = 1.0f, float brighter_in_the_middle = 1.0f) {
  std::mt19937 random(seed);
  Film film(kWidth, kHeight, false);
  for (std::size_t i = 0; i < film.samples.data().size(); ++i) {
    const float middle = i == kWidth * kHeight / 2 ? brighter_in_the_middle : 1.0f;
    const float scale = (0.1f + 0.01f * static_cast<float>(i)) * (i == 0 ? 1.0f : brighter_everywhere) * middle;
    for (int s = 0; s < samples; ++s) {
      const float scatter = i == 0 ? 1.0f : 2.0f * 0x1p-24f * static_cast<float>(random() >> 8);
      for (std::size_t c = 0; c < 3; ++c) film.sum.data()[3 * i + c] += scale * scatter;
      film.square.data()[i] += scale * scatter * scale * scatter;
    }
    film.samples.data()[i] = samples;
  }
  return film;
}

const Golden& golden() {
  static const Golden kGolden = [] {
    GoldenRun run;
    for (unsigned seed = 0; seed < 128; ++seed) run.add(noise(32, 1000 + seed));
    return run.result();
  }();
  return kGolden;
}

TEST(ZTest, accepts_a_picture_with_the_right_mean) { EXPECT_TRUE(z_test(noise(64, 2), golden()).passed()); }

TEST(ZTest, raises_false_alarms_with_probability_alpha) {
  constexpr int kTrials = 200;
  int alarms = 0;
  for (unsigned seed = 0; seed < kTrials; ++seed)
    alarms += z_test(noise(32, 100 + seed), golden(), 0.1).passed() ? 0 : 1;
  EXPECT_GT(alarms, 3);
  EXPECT_LT(alarms, 45);
}

TEST(ZTest, finds_one_pixel_that_is_too_bright) {
  const ZTest test = z_test(noise(64, 3, 1.0f, 1.6f), golden());
  EXPECT_FALSE(test.passed());
  EXPECT_LT(test.worst_p, test.level);
  EXPECT_EQ(test.worst_pixel, std::size_t{kWidth} * kHeight / 2);
  EXPECT_GT(test.z[test.worst_pixel], 4.0);
}

TEST(ZTest, finds_a_bias_of_the_whole_picture_that_no_pixel_shows) {
  const ZTest test = z_test(noise(64, 4, 1.05f), golden());
  EXPECT_GE(test.worst_p, test.level);
  EXPECT_LT(test.picture_p, test.level);
  EXPECT_FALSE(test.passed());
}

TEST(ZTest, requires_a_pixel_without_variance_to_be_right_up_to_rounding) {
  EXPECT_LT(std::abs(z_test(noise(64, 5), golden()).z[0]), 1.0);
  Film film = noise(64, 5);
  for (std::size_t c = 0; c < 3; ++c) film.sum.data()[c] *= 1.001f;
  EXPECT_FALSE(z_test(film, golden()).passed());
}

TEST(ZTest, rejects_nan) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Film film = noise(64, 6);
    film.sum.data()[30] = bad;
    EXPECT_FALSE(z_test(film, golden()).passed());
  }
  Film empty = noise(64, 6);
  empty.samples.data()[5] = 0;
  EXPECT_FALSE(z_test(empty, golden()).passed());
}

TEST(Golden, survives_a_round_trip) {
  const auto again = parse_golden(golden_text(golden(), "make it so"));
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->width, kWidth);
  EXPECT_EQ(again->height, kHeight);
  EXPECT_EQ(again->samples, 4096.0);
  ASSERT_EQ(again->mean.size(), golden().mean.size());
  for (std::size_t i = 0; i < again->mean.size(); ++i) {
    EXPECT_NEAR(again->mean[i], golden().mean[i], 1e-8 * golden().mean[i]);
    EXPECT_NEAR(again->variance[i], golden().variance[i], 1e-8 * golden().variance[i]);
  }
}

TEST(Golden, is_refused_if_truncated_or_too_long) {
  const std::string text = golden_text(golden(), "make it so");
  EXPECT_FALSE(parse_golden(text.substr(0, text.size() / 2)));
  EXPECT_FALSE(parse_golden(text + "1"));
  EXPECT_FALSE(parse_golden(""));
  EXPECT_FALSE(parse_golden("# no numbers\n"));
  EXPECT_FALSE(parse_golden("1 1 many\n0 0\n"));
}

}  // namespace
}  // namespace cyclorama::render
