// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/noise.h"

namespace cyclorama::generator {
namespace {

struct Lattice {
  int cell;
  float fraction;
};

Lattice lattice(float x) {
  const float floor = std::floor(x);
  return {static_cast<int>(floor), x - floor};
}

float fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

/// Returns the dot product of (x, y, z) with one of the 12 edge directions of a cube.
float gradient(std::uint32_t h, float x, float y, float z) {
  h &= 15u;
  const float a = h < 8u ? x : y;
  const float b = h < 4u ? y : (h == 12u || h == 14u ? x : z);
  return ((h & 1u) != 0u ? -a : a) + ((h & 2u) != 0u ? -b : b);
}

}  // namespace

std::uint32_t hash(int x, int y, int z, std::uint32_t seed) {
  // Constants and final mix of xxHash32 (Y. Collet), whose avalanche is good for small integers.
  std::uint32_t h = seed + 0x165667b1u;
  h = (h ^ static_cast<std::uint32_t>(x)) * 0x85ebca77u;
  h = (h ^ (h >> 15) ^ static_cast<std::uint32_t>(y)) * 0xc2b2ae3du;
  h = (h ^ (h >> 13) ^ static_cast<std::uint32_t>(z)) * 0x9e3779b1u;
  h = (h ^ (h >> 16)) * 0x85ebca77u;
  return h ^ (h >> 13);
}

float random_unit(int x, int y, std::uint32_t seed) {
  return static_cast<float>(hash(x, y, 0x5bd1, seed) >> 8) * 0x1.0p-24f;
}

float noise(const Vec3& p, std::uint32_t seed) {
  const auto [i, x] = lattice(p.x());
  const auto [j, y] = lattice(p.y());
  const auto [k, z] = lattice(p.z());
  const float u = fade(x);
  const float v = fade(y);
  const float w = fade(z);
  float planes[2];
  for (int dk = 0; dk < 2; ++dk) {
    const float zz = z - static_cast<float>(dk);
    const float near =
        mix(gradient(hash(i, j, k + dk, seed), x, y, zz), gradient(hash(i + 1, j, k + dk, seed), x - 1.0f, y, zz), u);
    const float far = mix(gradient(hash(i, j + 1, k + dk, seed), x, y - 1.0f, zz),
                          gradient(hash(i + 1, j + 1, k + dk, seed), x - 1.0f, y - 1.0f, zz), u);
    planes[dk] = mix(near, far, v);
  }
  return mix(planes[0], planes[1], w);
}

float fractal_noise(const Vec3& p, int octaves, std::uint32_t seed) {
  float sum = 0.0f;
  float height = 0.5f;
  float frequency = 1.0f;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += height * noise(p * frequency, seed + static_cast<std::uint32_t>(octave) * 7919u);
    height *= 0.5f;
    frequency *= 2.03f;  // With a factor of 2, the lattices of all octaves would share their zeros.
  }
  return sum * 1.4f;
}

float crack_lines(const Vec3& p, std::uint32_t seed) {
  const Vec3 bent =
      p + 0.35f * Vec3(noise(p * 1.7f, seed + 1u), noise(p * 1.7f, seed + 2u), noise(p * 1.7f, seed + 3u));
  const float line = 1.0f - std::abs(noise(bent, seed)) * 30.0f;
  // Most of a face has no cracks: they remain only where a second, lower-frequency noise is high.
  return unit_clamp(line) * smooth_step(0.12f, 0.35f, noise(p * 0.45f, seed + 4u));
}

float chisel_marks(const Vec2& p, std::uint32_t seed) {
  constexpr float kWorkWidth = 0.55f;
  constexpr float kFurrow = 0.085f;
  float sum = 0.0f;
  float weight = 0.0f;
  const auto [ci, fx] = lattice(p.x() / kWorkWidth);
  const auto [cj, fy] = lattice(p.y() / kWorkWidth);
  for (int dj = 0; dj < 2; ++dj) {
    for (int di = 0; di < 2; ++di) {
      const int i = ci + di;
      const int j = cj + dj;
      const float angle =
          mix(0.5f, 1.25f, random_unit(i, j, seed)) * (random_unit(j, i, seed + 5u) < 0.65f ? 1.0f : -1.0f);
      const float across =
          p.x() * std::cos(angle) + p.y() * std::sin(angle) + 0.02f * noise({p.x() * 4.0f, p.y() * 4.0f, 0.0f}, seed);
      const float w = (di == 0 ? 1.0f - fx : fx) * (dj == 0 ? 1.0f - fy : fy);
      const float sharp = w * w;
      sum += sharp * std::abs(lattice(across / kFurrow + random_unit(i, j, seed + 9u)).fraction - 0.5f) * 2.0f;
      weight += sharp;
    }
  }
  return sum / weight;
}

}  // namespace cyclorama::generator
