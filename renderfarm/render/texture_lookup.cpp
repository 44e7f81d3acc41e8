// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/texture_lookup.h"

#include <algorithm>
#include <cmath>

#include "common/image/colour.h"

namespace cyclorama::render {
namespace {

/// Upper bound of coordinates: beyond it, float cannot resolve positions inside one repeat.
constexpr float kMaxCoordinate = 1e6f;

/// Equals std::floor() without the function call, for values below kMaxCoordinate.
float floor_of(float value) {
  const auto towards_zero = static_cast<float>(static_cast<int>(value));
  return towards_zero - static_cast<float>(towards_zero > value);  // Branch-free, because signs are random.
}

/// Returns the coordinate reduced to [0, 1], or to [0, 2] for mirrored wrapping.
float reduced(float coordinate, scene::WrapMode mode) {
  if (!(std::abs(coordinate) < kMaxCoordinate)) return 0.0f;
  switch (mode) {
    case scene::WrapMode::kClamp:
      return std::clamp(coordinate, 0.0f, 1.0f);
    case scene::WrapMode::kRepeat:
      return coordinate - floor_of(coordinate);
    case scene::WrapMode::kMirror:
      return coordinate - 2.0f * floor_of(0.5f * coordinate);
  }
  return 0.0f;
}

/// Returns the index of a texel wrapped into range. Precondition: it belongs to a reduced() coordinate, so that one
/// step suffices.
int wrapped(int texel, int count, scene::WrapMode mode) {
  if (mode == scene::WrapMode::kRepeat) return texel + (texel < 0 ? count : 0) - (texel >= count ? count : 0);
  if (mode == scene::WrapMode::kMirror && texel >= count) texel = 2 * count - 1 - texel;
  return std::min(std::max(texel, 0), count - 1);
}

/// The two texels around a coordinate along one axis, and its fraction between them.
struct Pair {
  int first;
  int second;
  float between;
};

Pair pair_at(float reduced_place, int count, scene::WrapMode mode) {
  const float place = reduced_place * static_cast<float>(count) - 0.5f;
  const int first = static_cast<int>(place + 1.0f) - 1;  // Rounds down, because the argument is above 0.
  return {wrapped(first, count, mode), wrapped(first + 1, count, mode), place - static_cast<float>(first)};
}

int nearest_at(float reduced_place, int count, scene::WrapMode mode) {
  return wrapped(static_cast<int>(reduced_place * static_cast<float>(count)), count, mode);
}

std::array<float, 256> make_table(float (*decode)(float)) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = decode(static_cast<float>(i) / 255.0f);
  return table;
}

const std::array<float, 256> kSrgb = make_table(srgb_to_linear);
const std::array<float, 256> kLinear = make_table([](float code) { return code; });

Eigen::Vector4f decoded(const std::uint8_t* texel, const std::array<float, 256>& colour) {
  return {colour[texel[0]], colour[texel[1]], colour[texel[2]], kLinear[texel[3]]};
}

/// Filters one level at a reduced coordinate.
Eigen::Vector4f filtered(const MipTexture& texture, std::size_t index, float u, float v,
                         const std::array<float, 256>& colour) {
  const MipTexture::Level& level = texture.levels()[index];
  if (texture.nearest()) {
    return decoded(
        level.at(nearest_at(u, level.width, texture.wrap_u()), nearest_at(v, level.height, texture.wrap_v())), colour);
  }
  const Pair x = pair_at(u, level.width, texture.wrap_u());
  const Pair y = pair_at(v, level.height, texture.wrap_v());
  const Eigen::Vector4f upper = decoded(level.at(x.first, y.first), colour) * (1.0f - x.between) +
                                decoded(level.at(x.second, y.first), colour) * x.between;
  const Eigen::Vector4f lower = decoded(level.at(x.first, y.second), colour) * (1.0f - x.between) +
                                decoded(level.at(x.second, y.second), colour) * x.between;
  return upper * (1.0f - y.between) + lower * y.between;
}

}  // namespace

const std::array<float, 256>& srgb_table() { return kSrgb; }
const std::array<float, 256>& linear_table() { return kLinear; }

Eigen::Vector4f lookup(const MipTexture& texture, const Vec2& uv, Coding coding, float lod) {
  if (texture.levels().empty()) return Eigen::Vector4f::Ones();
  const std::array<float, 256>& colour = coding == Coding::kSrgb ? kSrgb : kLinear;
  const float u = reduced(uv.x(), texture.wrap_u());
  const float v = reduced(uv.y(), texture.wrap_v());
  if (!(lod > 0.0f)) return filtered(texture, 0, u, v, colour);
  const int last = static_cast<int>(texture.levels().size()) - 1;
  const float level = std::min(lod, static_cast<float>(last));
  if (texture.nearest()) return filtered(texture, static_cast<std::size_t>(level + 0.5f), u, v, colour);
  const int fine = std::min(static_cast<int>(level), last - 1);
  if (fine < 0) return filtered(texture, 0, u, v, colour);
  const float between = level - static_cast<float>(fine);
  return filtered(texture, static_cast<std::size_t>(fine), u, v, colour) * (1.0f - between) +
         filtered(texture, static_cast<std::size_t>(fine) + 1, u, v, colour) * between;
}

float lookup_alpha(const MipTexture& texture, const Vec2& uv) { return lookup(texture, uv, Coding::kLinear, 0.0f).w(); }

bool has_transparency(const scene::Texture& texture) {
  const std::span<const std::uint8_t> values = texture.pixels.data();
  for (std::size_t i = 3; i < values.size(); i += 4) {
    if (values[i] != 255) return true;
  }
  return false;
}

}  // namespace cyclorama::render
