// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/tone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/image/colour.h"

namespace cyclorama::render {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr scene::ToneCurve kCurves[] = {scene::ToneCurve::kShoulder, scene::ToneCurve::kLinear,
                                        scene::ToneCurve::kFilmic};

TEST(Tone, every_curve_rises_from_black_to_white_and_not_beyond) {
  for (const scene::ToneCurve curve : kCurves) {
    float before = 0.0f;
    for (float light = 1e-6f; light < 1e6f; light *= 1.01f) {
      const float shown = tone_mapped(light, curve);
      EXPECT_GE(shown, before) << light;
      EXPECT_LE(shown, 1.0f) << light;
      before = shown;
    }
    EXPECT_EQ(tone_mapped(0.0f, curve), 0.0f);
    EXPECT_EQ(tone_mapped(kInfinity, curve), 1.0f);
    EXPECT_EQ(tone_mapped(std::numeric_limits<float>::max(), curve), 1.0f);
  }
}

TEST(Tone, maps_negative_light_and_nan_to_black) {
  for (const scene::ToneCurve curve : kCurves) {
    for (const float light : {kNan, -kNan, -1.0f, -0.0f, -kInfinity}) {
      EXPECT_EQ(tone_mapped(light, curve), 0.0f);
      EXPECT_EQ(tone_table(curve).code(light), 0);
    }
  }
}

TEST(Tone, linear_clips_and_filmic_is_the_published_fit) {
  EXPECT_EQ(tone_mapped(0.7f, scene::ToneCurve::kLinear), 0.7f);
  EXPECT_EQ(tone_mapped(1.5f, scene::ToneCurve::kLinear), 1.0f);
  // x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), computed by hand.
  EXPECT_NEAR(tone_mapped(1.0f, scene::ToneCurve::kFilmic), 2.54f / 3.16f, 1e-6f);
  EXPECT_NEAR(tone_mapped(0.1f, scene::ToneCurve::kFilmic), 0.0281f / 0.2233f, 1e-6f);
  EXPECT_GT(tone_mapped(7.2f, scene::ToneCurve::kFilmic), 0.999f);
}

TEST(Tone, the_table_gives_the_code_of_the_formula) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-14.0f, 5.0f);
  for (const scene::ToneCurve curve : kCurves) {
    const ToneTable& table = tone_table(curve);
    for (int i = 0; i < 200000; ++i) {
      const float light = std::exp2(exponent(random));
      ASSERT_EQ(table.code(light), linear_to_srgb8(tone_mapped(light, curve))) << light;
    }
    for (const float light : {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::min(), 1e-20f,
                              1e20f, std::numeric_limits<float>::max(), kInfinity}) {
      EXPECT_EQ(table.code(light), linear_to_srgb8(tone_mapped(light, curve))) << light;
    }
  }
}

TEST(Tone, develops_every_value_of_a_picture) {
  RadianceImage light(3, 2);
  for (std::size_t i = 0; i < light.data().size(); ++i) light.data()[i] = 0.05f * static_cast<float>(i);
  light.data()[4] = kNan;
  const RgbImage codes = developed(light, scene::ToneCurve::kLinear);
  ASSERT_EQ(codes.width(), 3);
  ASSERT_EQ(codes.height(), 2);
  for (std::size_t i = 0; i < light.data().size(); ++i) EXPECT_EQ(codes.data()[i], linear_to_srgb8(light.data()[i]));
}

}  // namespace
}  // namespace cyclorama::render
