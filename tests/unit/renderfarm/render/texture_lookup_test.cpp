// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/texture_lookup.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::render {
namespace {

/// Four texels in a row or column: R = 0, 85, 170, 255.
scene::Texture ramp(bool vertical, scene::WrapMode wrap) {
  scene::Texture texture;
  texture.pixels = vertical ? RgbaImage(1, 4, 255) : RgbaImage(4, 1, 255);
  for (int i = 0; i < 4; ++i)
    texture.pixels.at(vertical ? 0 : i, vertical ? i : 0)[0] = static_cast<std::uint8_t>(85 * i);
  texture.wrap_u = wrap;
  texture.wrap_v = wrap;
  return texture;
}
MipTexture mips(const scene::Texture& texture) { return {texture, TextureContent::kData}; }
float red(const scene::Texture& texture, float u, float v = 0.5f, float lod = 0.0f) {
  return lookup(mips(texture), {u, v}, Coding::kLinear, lod).x();
}

TEST(TextureLookup, returns_the_texel_at_its_centre) {
  const scene::Texture texture = ramp(false, scene::WrapMode::kClamp);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(red(texture, (static_cast<float>(i) + 0.5f) / 4.0f), static_cast<float>(i) / 3.0f, 1e-6f);
  }
}

TEST(TextureLookup, is_linear_between_two_centres) {
  EXPECT_NEAR(red(ramp(false, scene::WrapMode::kClamp), 0.25f), 0.5f / 3.0f, 1e-6f);
  EXPECT_NEAR(red(ramp(false, scene::WrapMode::kClamp), 0.5f), 0.5f, 1e-6f);
}

TEST(TextureLookup, v_increases_downwards_from_the_first_row) {
  EXPECT_NEAR(red(ramp(true, scene::WrapMode::kClamp), 0.5f, 0.125f), 0.0f, 1e-6f);
  EXPECT_NEAR(red(ramp(true, scene::WrapMode::kClamp), 0.5f, 0.875f), 1.0f, 1e-6f);
}

TEST(TextureLookup, wraps_at_the_edges_as_specified) {
  const scene::Texture clamp = ramp(false, scene::WrapMode::kClamp);
  EXPECT_NEAR(red(clamp, 0.0f), 0.0f, 1e-6f);
  EXPECT_NEAR(red(clamp, 1.0f), 1.0f, 1e-6f);
  EXPECT_NEAR(red(clamp, -7.3f), 0.0f, 1e-6f);
  EXPECT_NEAR(red(clamp, 7.3f), 1.0f, 1e-6f);

  const scene::Texture repeat = ramp(false, scene::WrapMode::kRepeat);
  EXPECT_NEAR(red(repeat, 0.0f), 0.5f, 1e-6f);  // Half of the last texel, half of the first.
  EXPECT_NEAR(red(repeat, 1.0f), 0.5f, 1e-6f);
  EXPECT_NEAR(red(repeat, 3.375f), 1.0f / 3.0f, 1e-6f);
  EXPECT_NEAR(red(repeat, -0.125f), 1.0f, 1e-6f);

  const scene::Texture mirror = ramp(false, scene::WrapMode::kMirror);
  EXPECT_NEAR(red(mirror, 0.0f), 0.0f, 1e-6f);
  EXPECT_NEAR(red(mirror, 1.0f), 1.0f, 1e-6f);
  EXPECT_NEAR(red(mirror, 1.125f), 1.0f, 1e-6f);
  EXPECT_NEAR(red(mirror, 1.375f), 2.0f / 3.0f, 1e-6f);
  EXPECT_NEAR(red(mirror, -0.375f), 1.0f / 3.0f, 1e-6f);
  EXPECT_NEAR(red(mirror, 2.125f), 0.0f, 1e-6f);
}

TEST(TextureLookup, nearest_filtering_returns_one_texel) {
  scene::Texture texture = ramp(false, scene::WrapMode::kRepeat);
  texture.nearest = true;
  EXPECT_EQ(red(texture, 0.26f), 85.0f / 255.0f);
  EXPECT_EQ(red(texture, 0.49f), 85.0f / 255.0f);
  EXPECT_EQ(red(texture, 1.0f), 0.0f);
  texture.wrap_u = scene::WrapMode::kClamp;
  EXPECT_EQ(red(texture, 1.0f), 1.0f);
}

TEST(TextureLookup, filters_in_linear_light_and_alpha_linearly) {
  scene::Texture texture;
  texture.pixels = RgbaImage(2, 1);
  for (int c = 0; c < 4; ++c) texture.pixels.at(1, 0)[c] = 255;
  texture.wrap_u = scene::WrapMode::kClamp;
  const Eigen::Vector4f middle = lookup(mips(texture), {0.5f, 0.5f}, Coding::kSrgb, 0.0f);
  EXPECT_NEAR(middle.x(), 0.5f, 1e-6f);
  EXPECT_NEAR(middle.w(), 0.5f, 1e-6f);
  EXPECT_NEAR(lookup_alpha(mips(texture), {0.5f, 0.5f}), 0.5f, 1e-6f);
  texture.pixels = RgbaImage(1, 1, 128);
  EXPECT_NEAR(lookup(mips(texture), {0.5f, 0.5f}, Coding::kSrgb, 0.0f).x(), 0.2158605f, 1e-5f);
  EXPECT_NEAR(lookup(mips(texture), {0.5f, 0.5f}, Coding::kSrgb, 0.0f).w(), 128.0f / 255.0f, 1e-6f);
}

TEST(TextureLookup, is_finite_for_extreme_coordinates) {
  for (const scene::WrapMode wrap : {scene::WrapMode::kRepeat, scene::WrapMode::kMirror, scene::WrapMode::kClamp}) {
    for (const bool nearest : {false, true}) {
      scene::Texture texture = ramp(false, wrap);
      texture.nearest = nearest;
      for (const float u : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(), 3e38f, -3e38f, 1e-45f, 999999.9f, -1e-9f}) {
        for (const float lod : {0.0f, 0.7f, 2.0f, 9.0f, std::numeric_limits<float>::quiet_NaN()}) {
          const float value = red(texture, u, u, lod);
          EXPECT_TRUE(value >= 0.0f && value <= 1.0f) << u << " at level " << lod;
        }
      }
    }
  }
  EXPECT_TRUE(lookup(mips(scene::Texture{}), {0.5f, 0.5f}, Coding::kSrgb, 3.0f).isOnes());
}

TEST(TextureLookup, reports_whether_anything_is_transparent) {
  scene::Texture texture = ramp(false, scene::WrapMode::kClamp);
  EXPECT_FALSE(has_transparency(texture));
  texture.pixels.at(3, 0)[3] = 254;
  EXPECT_TRUE(has_transparency(texture));
  EXPECT_FALSE(has_transparency(scene::Texture{}));
}

}  // namespace
}  // namespace cyclorama::render
