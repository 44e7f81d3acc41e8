// SPDX-License-Identifier: Apache-2.0
/// Owen-scrambled Sobol points that depend on (seed, pixel, sample, dimension) alone, not on tiling or threads.
///
/// Pixels are numbered along a Z-order curve and share one scrambled sequence, so that the samples of neighbouring
/// pixels complement each other and the remaining noise has high frequency. Sources: Burley, "Practical Hash-based Owen
/// Scrambling", JCGT 9(4), 2020; the hash as improved by Vegdahl, 2021; Ahmed and Wonka, "Screen-Space Blue-Noise
/// Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", 2020.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Hashes 32 bits. Source: Wellons, "Prospecting for Hash Functions", 2018 (nullprogram.com).
[[nodiscard]] constexpr std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

[[nodiscard]] constexpr std::uint32_t reversed_bits(std::uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/// Owen-scrambles a number whose bits are given in reverse.
[[nodiscard]] constexpr std::uint32_t scrambled_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Returns the second Sobol dimension with its bits reversed: Pascal's triangle modulo 2 applied to the index.
[[nodiscard]] constexpr std::uint32_t sobol_second_reversed(std::uint32_t index) {
  index ^= (index & 0xaaaaaaaau) >> 1;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xffff0000u) >> 16;
  return index;
}

[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t v = x;
  v = (v | (v << 16)) & 0x0000ffff0000ffffu;
  v = (v | (v << 8)) & 0x00ff00ff00ff00ffu;
  v = (v | (v << 4)) & 0x0f0f0f0f0f0f0f0fu;
  v = (v | (v << 2)) & 0x3333333333333333u;
  return (v | (v << 1)) & 0x5555555555555555u;
}

/// Maps the upper 24 bits to [0, 1).
[[nodiscard]] constexpr float to_unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

struct SobolPoint {
  float u = 0.0f;
  float v = 0.0f;
};

/// Returns point number `index` of the two-dimensional sequence that (seed, dimension) identifies. The index is given
/// with its bits reversed; it is shuffled, and both coordinates are scrambled, all by Owen's method. Inlining is forced
/// because loops over many points are vectorised only then.
[[nodiscard, gnu::always_inline]] constexpr SobolPoint sobol_point(std::uint32_t index_reversed, std::uint32_t seed,
                                                                   std::uint32_t dimension) {
  const std::uint32_t own_seed = mix_bits(seed + 0x9e3779b9u * (dimension + 1));
  const std::uint32_t index = reversed_bits(scrambled_reversed(index_reversed, own_seed));
  const std::uint32_t u = reversed_bits(scrambled_reversed(index, mix_bits(own_seed + 1)));
  const std::uint32_t v = reversed_bits(scrambled_reversed(sobol_second_reversed(index), mix_bits(own_seed + 2)));
  return {to_unit_float(u), to_unit_float(v)};
}

/// Returns only the first coordinate of sobol_point().
[[nodiscard]] constexpr float sobol_value(std::uint32_t index_reversed, std::uint32_t seed, std::uint32_t dimension) {
  const std::uint32_t own_seed = mix_bits(seed + 0x9e3779b9u * (dimension + 1));
  const std::uint32_t index = reversed_bits(scrambled_reversed(index_reversed, own_seed));
  return to_unit_float(reversed_bits(scrambled_reversed(index, mix_bits(own_seed + 1))));
}

/// Returns the index, with its bits reversed, of sub-sample `part` of a sample that is split into 2^bits parts. The
/// points of all parts of all samples form one longer sequence.
[[nodiscard]] constexpr std::uint32_t split_index_reversed(std::uint32_t index_reversed, int bits, std::uint32_t part) {
  return bits == 0 ? index_reversed : (index_reversed >> bits) | reversed_bits(part);
}

/// The random numbers of one sample of one pixel. A value.
class SampleSequence {
 public:
  /// Precondition: `sample` is in [0, samples); `samples` is the length of the pixel's sequence.
  SampleSequence(std::uint64_t seed, int x, int y, int sample, int samples) {
    const std::uint64_t pixel = spread_bits(static_cast<std::uint32_t>(x)) | spread_bits(static_cast<std::uint32_t>(y))
                                                                                 << 1;
    const auto bits = std::bit_width(static_cast<std::uint32_t>(samples - 1));
    const std::uint64_t index = (pixel << bits) | static_cast<std::uint32_t>(sample);
    index_reversed_ = reversed_bits(static_cast<std::uint32_t>(index));
    // A picture with more than 2^32 samples is divided into blocks, each with a separate sequence.
    seed_ = mix_bits(static_cast<std::uint32_t>(seed) ^ mix_bits(static_cast<std::uint32_t>(seed >> 32) ^
                                                                 mix_bits(static_cast<std::uint32_t>(index >> 32))));
  }

  /// Returns a point of the unit square; different dimensions give independent points.
  [[nodiscard]] Vec2 pair(std::uint32_t dimension) const {
    const SobolPoint point = sobol_point(index_reversed_, seed_, dimension);
    return {point.u, point.v};
  }
  /// index_reversed() and seed() are the state of the sequence: the sample's number with its bits reversed, and the
  /// seed of the scramble.
  [[nodiscard]] std::uint32_t index_reversed() const { return index_reversed_; }
  [[nodiscard]] std::uint32_t seed() const { return seed_; }

 private:
  std::uint32_t index_reversed_ = 0;
  std::uint32_t seed_ = 0;
};

}  // namespace cyclorama::render
