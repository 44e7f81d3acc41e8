// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/mip_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/image/colour.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

template <typename Texel>
scene::Texture drawn(int width, int height, const Texel& texel) {
  scene::Texture texture;
  texture.pixels = RgbaImage(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Rgba value = texel(x, y);
      std::copy(value.begin(), value.end(), texture.pixels.at(x, y));
    }
  }
  return texture;
}

scene::Texture noise(int width, int height) {
  std::mt19937 random(3);
  const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
  return drawn(width, height, [&](int, int) { return Rgba{byte(), byte(), byte(), byte()}; });
}

Rgba texel(const MipTexture& mips, std::size_t level, int x = 0, int y = 0) {
  const std::uint8_t* const t = mips.levels().at(level).at(x, y);
  return {t[0], t[1], t[2], t[3]};
}

TEST(MipTexture, averages_a_checkerboard_in_linear_light) {
  const scene::Texture board = drawn(8, 8, [](int x, int y) {
    const auto c = static_cast<std::uint8_t>((x + y) % 2 == 0 ? 255 : 0);
    return Rgba{c, c, c, 255};
  });
  const MipTexture mips(board, TextureContent::kColour);
  ASSERT_EQ(mips.levels().size(), 4U);
  for (std::size_t level = 1; level < 4; ++level) {
    EXPECT_EQ(texel(mips, level), (Rgba{188, 188, 188, 255}));
    EXPECT_NEAR(srgb_table()[texel(mips, level)[0]], 0.5f, 0.005f);
  }
  EXPECT_EQ(texel(MipTexture(board, TextureContent::kData), 3), (Rgba{128, 128, 128, 255}));
}

TEST(MipTexture, transparent_texels_do_not_colour_opaque_ones) {
  const scene::Texture leaf = drawn(2, 2, [](int x, int y) {
    return x + y == 0 ? Rgba{0, 255, 0, 255} : Rgba{255, 0, 255, 0};
  });
  EXPECT_EQ(texel(MipTexture(leaf, TextureContent::kColourWithAlpha), 1), (Rgba{0, 255, 0, 64}));
  EXPECT_NE(texel(MipTexture(leaf, TextureContent::kColour), 1)[0], 0);
  const scene::Texture air = drawn(2, 2, [](int, int) { return Rgba{10, 20, 30, 0}; });
  EXPECT_EQ(texel(MipTexture(air, TextureContent::kColourWithAlpha), 1), (Rgba{10, 20, 30, 0}));
}

TEST(MipTexture, normals_are_averaged_as_vectors) {
  // 45 degrees to the left, 45 degrees to the right, and straight: the mean is straight.
  const scene::Texture bumps = drawn(4, 1, [](int x, int) {
    return x == 0 ? Rgba{218, 128, 218, 255} : x == 1 ? Rgba{38, 128, 218, 255} : Rgba{128, 128, 255, 255};
  });
  const MipTexture mips(bumps, TextureContent::kData);
  EXPECT_EQ(texel(mips, 1), (Rgba{128, 128, 218, 255}));
  EXPECT_EQ(texel(mips, 2), (Rgba{128, 128, 236, 255}));
}

TEST(MipTexture, shares_level_0_with_the_scene_and_adds_a_third) {
  const scene::Texture texture = noise(256, 256);
  const MipTexture mips(texture, TextureContent::kColour);
  EXPECT_EQ(mips.levels().front().texels, texture.pixels.data().data());
  EXPECT_EQ(mips.bytes(), mip_bytes(texture));
  EXPECT_LE(3 * mips.bytes(), texture.pixels.data().size());
}

/// Sizes that are not powers of two: every texel has equal weight in every level.
TEST(MipTexture, keeps_the_mean_for_any_size) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 7}, std::pair{64, 1}, std::pair{3, 3},
                                      std::pair{5, 128}, std::pair{127, 33}, std::pair{640, 257}}) {
    const scene::Texture texture = noise(width, height);
    for (const TextureContent content : {TextureContent::kData, TextureContent::kColour}) {
      const MipTexture mips(texture, content);
      EXPECT_EQ(mips.levels().back().width, 1);
      EXPECT_EQ(mips.levels().back().height, 1);
      const auto& decode = content == TextureContent::kData ? linear_table() : srgb_table();
      double mean = 0.0;
      for (std::size_t i = 0; i < texture.pixels.data().size(); i += 4) mean += decode[texture.pixels.data()[i]];
      mean /= width * height;
      const double slope = content == TextureContent::kData ? 1.0 / 255.0 : 2.0 / 255.0;  // Approximate light per code.
      EXPECT_NEAR(decode[texel(mips, mips.levels().size() - 1)[0]], mean, 1.2 * slope) << width << "x" << height;
    }
  }
}

TEST(MipTexture, weights_seven_texels_equally_in_three) {
  const scene::Texture seven = drawn(7, 1, [](int x, int) {
    return Rgba{static_cast<std::uint8_t>(x == 2 ? 252 : 0), 0, 0, 255};
  });
  const MipTexture mips(seven, TextureContent::kData);
  EXPECT_EQ(texel(mips, 1, 0)[0], 36);  // A third of texel 2, divided by 7 / 3.
  EXPECT_EQ(texel(mips, 1, 1)[0], 72);
  EXPECT_EQ(texel(mips, 1, 2)[0], 0);
}

TEST(MipTexture, accepts_one_texel_and_16000_by_1000) {
  const scene::Texture one = drawn(1, 1, [](int, int) { return Rgba{1, 2, 3, 4}; });
  const MipTexture single(one, TextureContent::kColour);
  EXPECT_EQ(single.levels().size(), 1U);
  EXPECT_EQ(single.bytes(), 0U);
  EXPECT_NEAR(lookup(single, {0.3f, 9.0f}, Coding::kLinear, 50.0f).z(), 3.0f / 255.0f, 1e-6f);

  for (const int height : {4, 1024}) {
    scene::Texture wide;
    wide.pixels = RgbaImage(16384, height, 77);
    wide.wrap_u = wide.wrap_v = scene::WrapMode::kClamp;
    std::fill_n(wide.pixels.at(16383, 0), 4, std::uint8_t{177});
    const MipTexture mips(wide, TextureContent::kData);
    ASSERT_EQ(mips.levels().size(), 15U);
    EXPECT_EQ(mips.levels()[4].width, 1024);
    EXPECT_EQ(mips.levels()[4].height, std::max(1, height / 16));
    EXPECT_NEAR(texel(mips, 14)[3], 77, 1);
    EXPECT_NEAR(lookup(mips, {1.0f, 0.0f}, Coding::kLinear, 0.0f).x(), 177.0f / 255.0f, 1e-3f);
    EXPECT_NEAR(lookup(mips, {0.5f, 0.5f}, Coding::kLinear, 7.5f).x(), 77.0f / 255.0f, 1e-6f);
  }
}

TEST(MipTexture, wraps_at_every_level) {
  for (const scene::WrapMode mode : {scene::WrapMode::kRepeat, scene::WrapMode::kMirror, scene::WrapMode::kClamp}) {
    scene::Texture texture = drawn(16, 16, [](int x, int) {
      return Rgba{static_cast<std::uint8_t>(x < 8 ? 200 : 0), 0, 0, 255};
    });
    texture.wrap_u = mode;
    const MipTexture mips(texture, TextureContent::kData);
    const float light = 200.0f / 255.0f;
    for (const float lod : {0.0f, 1.0f, 2.0f, 3.0f}) {
      const auto red = [&](float u) { return lookup(mips, {u, 0.5f}, Coding::kLinear, lod).x(); };
      EXPECT_NEAR(red(0.0f), mode == scene::WrapMode::kRepeat ? 0.5f * light : light, 1e-5f) << lod;
      EXPECT_NEAR(red(1.0f), mode == scene::WrapMode::kRepeat ? 0.5f * light : 0.0f, 1e-5f) << lod;
      EXPECT_NEAR(red(1.25f), mode == scene::WrapMode::kRepeat ? light : 0.0f, 1e-5f) << lod;
      EXPECT_NEAR(red(-0.25f), mode == scene::WrapMode::kRepeat ? 0.0f : light, 1e-5f) << lod;
      EXPECT_NEAR(red(0.5f), 0.5f * light, 1e-5f) << lod;
    }
    EXPECT_NEAR(lookup(mips, {0.9f, 0.1f}, Coding::kLinear, 4.0f).x(), 0.5f * light, 1e-5f);
  }
}

TEST(MipTexture, is_linear_between_levels_and_constant_beyond_the_last) {
  const scene::Texture texture = drawn(2, 2, [](int x, int) {
    return Rgba{static_cast<std::uint8_t>(x == 0 ? 200 : 100), 0, 0, 255};
  });
  const MipTexture mips(texture, TextureContent::kData);
  const auto red = [&](float lod) { return 255.0f * lookup(mips, {0.25f, 0.25f}, Coding::kLinear, lod).x(); };
  EXPECT_NEAR(red(-3.0f), 200.0f, 1e-3f);
  EXPECT_NEAR(red(0.25f), 187.5f, 1e-3f);
  EXPECT_NEAR(red(0.5f), 175.0f, 1e-3f);
  EXPECT_NEAR(red(1.0f), 150.0f, 1e-3f);
  EXPECT_NEAR(red(INFINITY), 150.0f, 1e-3f);
}

TEST(MipTexture, uses_no_interpolation_with_nearest_filtering) {
  scene::Texture texture = drawn(4, 4, [](int x, int y) {
    return Rgba{static_cast<std::uint8_t>(40 * x + 10 * y), 0, 0, 255};
  });
  texture.nearest = true;
  const MipTexture mips(texture, TextureContent::kData);
  const auto code = [&](float u, float lod) {
    return std::lround(255.0f * lookup(mips, {u, 0.1f}, Coding::kLinear, lod).x());
  };
  EXPECT_EQ(code(0.49f, 0.4f), 40);
  EXPECT_EQ(code(0.49f, 0.6f), texel(mips, 1, 0, 0)[0]);
  EXPECT_EQ(code(0.51f, 1.4f), texel(mips, 1, 1, 0)[0]);
  EXPECT_EQ(code(0.51f, INFINITY), texel(mips, 2, 0, 0)[0]);
}

TEST(MipTextures, makes_one_pyramid_per_picture_and_use) {
  scene::Model model;
  model.textures.push_back(noise(8, 8));
  scene::TextureUse use;
  MipTextures textures;
  EXPECT_EQ(textures.request(model, use, TextureContent::kColour), nullptr);
  use.texture = 0;
  const MipTexture* const colour = textures.request(model, use, TextureContent::kColour);
  EXPECT_EQ(textures.request(model, use, TextureContent::kColour), colour);
  const MipTexture* const data = textures.request(model, use, TextureContent::kData);
  EXPECT_NE(data, colour);
  textures.build(2);
  EXPECT_EQ(colour->levels().size(), 4U);
  EXPECT_EQ(textures.bytes(), 2 * mip_bytes(model.textures[0]));
  EXPECT_NE(texel(*colour, 3)[0], texel(*data, 3)[0]);
}

}  // namespace
}  // namespace cyclorama::render
