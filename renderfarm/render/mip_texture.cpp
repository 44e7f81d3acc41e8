// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/mip_texture.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/image/colour.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama::render {
namespace {

constexpr int kTexelsPerTask = 1 << 14;

/// The texels of a row or column that one texel of the next level covers, with their weights, which sum to 1.
struct Taps {
  int first = 0;
  int count = 1;
  std::array<float, 3> weights{1.0f, 0.0f, 0.0f};
};

int half_of(int size) { return std::max(1, size / 2); }

Taps taps_of(int target, int source_size) {
  const int first = 2 * target;
  if (source_size == 1) return {};
  if (source_size % 2 == 0) return {first, 2, {0.5f, 0.5f, 0.0f}};
  // 2m + 1 texels map to m texels, each of which covers 2 + 1/m and shares its outer ones with its neighbours.
  const auto m = static_cast<float>(source_size / 2);
  const auto i = static_cast<float>(target);
  const float covered = 2.0f + 1.0f / m;
  return {first, 3, {(1.0f - i / m) / covered, 1.0f / covered, (i + 1.0f) / m / covered}};
}

std::vector<Taps> all_taps(int source_size) {
  std::vector<Taps> taps;
  for (int i = 0; i < half_of(source_size); ++i) taps.push_back(taps_of(i, source_size));
  return taps;
}

std::uint8_t rounded(float code) { return static_cast<std::uint8_t>(std::lrint(std::clamp(code, 0.0f, 255.0f))); }

/// Mean of texels. Codes of linear data are summed without decoding: these sums are exact, and ties round to even.
template <TextureContent kContent>
struct Mean {
  std::array<float, 3> sum{};
  float alpha = 0.0f;
  std::array<float, 3> by_alpha{};

  void add(const std::uint8_t* texel, float weight) {
    const auto a = static_cast<float>(texel[3]);
    alpha += weight * a;
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = kContent == TextureContent::kData ? static_cast<float>(texel[c]) : srgb_table()[texel[c]];
      sum[c] += weight * value;
      if constexpr (kContent == TextureContent::kColourWithAlpha) by_alpha[c] += weight * a * value;
    }
  }
  void store(std::uint8_t* out) const {
    for (std::size_t c = 0; c < 3; ++c) {
      if constexpr (kContent == TextureContent::kData) {
        out[c] = rounded(sum[c]);
      } else {
        // An invisible texel keeps its plain mean colour, because interpolation bleeds it into its neighbours.
        const bool shows = kContent == TextureContent::kColourWithAlpha && alpha > 0.0f;
        out[c] = linear_to_srgb8(shows ? by_alpha[c] / alpha : sum[c]);
      }
    }
    out[3] = rounded(alpha);
  }
};

template <TextureContent kContent>
void shrink(const MipTexture::Level& from, int width, int height, std::uint8_t* out) {
  const std::vector<Taps> columns = all_taps(from.width);
  const std::vector<Taps> rows = all_taps(from.height);
  const auto shrink_rows = [&](const tbb::blocked_range<int>& range) {
    for (int y = range.begin(); y < range.end(); ++y) {
      const Taps& row = rows[static_cast<std::size_t>(y)];
      std::uint8_t* texel = out + 4 * static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
      for (const Taps& column : columns) {
        Mean<kContent> mean;
        for (int j = 0; j < row.count; ++j) {
          const std::uint8_t* const in = from.at(column.first, row.first + j);
          for (int i = 0; i < column.count; ++i) {
            mean.add(in + 4 * i,
                     row.weights[static_cast<std::size_t>(j)] * column.weights[static_cast<std::size_t>(i)]);
          }
        }
        mean.store(texel);
        texel += 4;
      }
    }
  };
  const auto grain = static_cast<std::size_t>(std::max(1, kTexelsPerTask / width));
  tbb::parallel_for(tbb::blocked_range<int>(0, height, grain), shrink_rows);
}

void shrink(const MipTexture::Level& from, int width, int height, TextureContent content, std::uint8_t* out) {
  switch (content) {
    case TextureContent::kColour:
      return shrink<TextureContent::kColour>(from, width, height, out);
    case TextureContent::kColourWithAlpha:
      return shrink<TextureContent::kColourWithAlpha>(from, width, height, out);
    case TextureContent::kData:
      return shrink<TextureContent::kData>(from, width, height, out);
  }
}

}  // namespace

MipTexture::MipTexture(const scene::Texture& source, TextureContent content)
    : smaller_(mip_bytes(source)), wrap_u_(source.wrap_u), wrap_v_(source.wrap_v), nearest_(source.nearest) {
  if (source.pixels.empty()) return;
  if (content == TextureContent::kColourWithAlpha && !has_transparency(source)) content = TextureContent::kColour;
  levels_.push_back({source.pixels.data().data(), source.pixels.width(), source.pixels.height()});
  std::uint8_t* out = smaller_.data();
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level from = levels_.back();
    const Level to{out, half_of(from.width), half_of(from.height)};
    shrink(from, to.width, to.height, content, out);
    out += 4 * static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height);
    levels_.push_back(to);
  }
}

std::size_t mip_bytes(const scene::Texture& texture) {
  std::size_t bytes = 0;
  int width = texture.pixels.width();
  int height = texture.pixels.height();
  while (width > 1 || height > 1) {
    if (width == 0 || height == 0) return 0;
    width = half_of(width);
    height = half_of(height);
    bytes += 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  return bytes;
}

const MipTexture* MipTextures::request(const scene::Model& model, const scene::TextureUse& use,
                                       TextureContent content) {
  if (use.texture < 0) return nullptr;
  const scene::Texture& source = model.textures[static_cast<std::size_t>(use.texture)];
  std::unique_ptr<MipTexture>& made = made_[{&source, content}];
  if (made == nullptr) made = std::make_unique<MipTexture>(scene::Texture{}, content);
  return made.get();
}

void MipTextures::build(int threads) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for_each(made_, [](auto& made) {
      const auto& [source, content] = made.first;
      *made.second = MipTexture(*source, content);
    });
  });
}

std::size_t MipTextures::bytes() const {
  std::size_t sum = 0;
  for (const auto& [key, texture] : made_) sum += texture->bytes();
  return sum;
}

}  // namespace cyclorama::render
