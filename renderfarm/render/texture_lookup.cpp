// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/texture_lookup.h"

#include <algorithm>
#include <cmath>

#include "common/image/colour.h"

namespace cyclorama {
namespace {

/// Beyond this, float has no digits left for the place inside one repeat.
constexpr float kLargestCoordinate = 1e6f;

int wrapped(int texel, int count, WrapMode mode) {
  switch (mode) {
    case WrapMode::kClamp:
      return std::clamp(texel, 0, count - 1);
    case WrapMode::kRepeat: {
      const int rest = texel % count;
      return rest < 0 ? rest + count : rest;
    }
    case WrapMode::kMirror: {
      const int period = 2 * count;
      const int rest = ((texel % period) + period) % period;
      return rest < count ? rest : period - 1 - rest;
    }
  }
  return 0;
}

/// The coordinate brought near [0, 1], so that it fits an int after scaling.
float reduced(float coordinate, WrapMode mode) {
  if (!(std::abs(coordinate) < kLargestCoordinate)) return 0.0f;
  switch (mode) {
    case WrapMode::kClamp:
      return std::clamp(coordinate, 0.0f, 1.0f);
    case WrapMode::kRepeat:
      return coordinate - std::floor(coordinate);
    case WrapMode::kMirror:
      return coordinate - 2.0f * std::floor(0.5f * coordinate);
  }
  return 0.0f;
}

/// The texels around a place, and how much each weighs.
struct Footprint {
  std::array<const std::uint8_t*, 4> texels;
  std::array<float, 4> weights;
};

Footprint footprint_of(const Texture& texture, const Vec2& uv) {
  const int width = texture.pixels.width();
  const int height = texture.pixels.height();
  const float x = reduced(uv.x(), texture.wrap_u) * static_cast<float>(width);
  const float y = reduced(uv.y(), texture.wrap_v) * static_cast<float>(height);
  if (texture.nearest) {
    const int column = wrapped(static_cast<int>(std::floor(x)), width, texture.wrap_u);
    const int row = wrapped(static_cast<int>(std::floor(y)), height, texture.wrap_v);
    const std::uint8_t* const texel = texture.pixels.at(column, row);
    return {{texel, texel, texel, texel}, {1.0f, 0.0f, 0.0f, 0.0f}};
  }
  const float left = std::floor(x - 0.5f);
  const float top = std::floor(y - 0.5f);
  const float fx = x - 0.5f - left;
  const float fy = y - 0.5f - top;
  const int x0 = wrapped(static_cast<int>(left), width, texture.wrap_u);
  const int x1 = wrapped(static_cast<int>(left) + 1, width, texture.wrap_u);
  const int y0 = wrapped(static_cast<int>(top), height, texture.wrap_v);
  const int y1 = wrapped(static_cast<int>(top) + 1, height, texture.wrap_v);
  return {{texture.pixels.at(x0, y0), texture.pixels.at(x1, y0), texture.pixels.at(x0, y1), texture.pixels.at(x1, y1)},
          {(1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy}};
}

std::array<float, 256> make_table(float (*decode)(float)) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = decode(static_cast<float>(i) / 255.0f);
  return table;
}

}  // namespace

const std::array<float, 256>& srgb_table() {
  static const std::array<float, 256> table = make_table(srgb_to_linear);
  return table;
}

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = make_table([](float code) { return code; });
  return table;
}

Eigen::Vector4f lookup(const Texture& texture, const Vec2& uv, Coding coding) {
  if (texture.pixels.empty()) return Eigen::Vector4f::Ones();
  const Footprint at = footprint_of(texture, uv);
  const std::array<float, 256>& colour = coding == Coding::kSrgb ? srgb_table() : linear_table();
  const std::array<float, 256>& alpha = linear_table();
  Eigen::Vector4f sum = Eigen::Vector4f::Zero();
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint8_t* const t = at.texels[i];
    sum += at.weights[i] * Eigen::Vector4f(colour[t[0]], colour[t[1]], colour[t[2]], alpha[t[3]]);
  }
  return sum;
}

float lookup_alpha(const Texture& texture, const Vec2& uv) {
  if (texture.pixels.empty()) return 1.0f;
  const Footprint at = footprint_of(texture, uv);
  float sum = 0.0f;
  for (std::size_t i = 0; i < 4; ++i) sum += at.weights[i] * linear_table()[at.texels[i][3]];
  return sum;
}

bool has_transparency(const Texture& texture) {
  const std::span<const std::uint8_t> values = texture.pixels.data();
  for (std::size_t i = 3; i < values.size(); i += 4) {
    if (values[i] != 255) return true;
  }
  return false;
}

}  // namespace cyclorama
