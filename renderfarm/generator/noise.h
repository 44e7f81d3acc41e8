// SPDX-License-Identifier: Apache-2.0
/// Repeatable randomness: pure functions of position and seed, so that the result does not depend on the thread that
/// computes a row.
#pragma once

#include <cstdint>

#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

/// Hashes the integers so that neighbouring inputs give unrelated values.
[[nodiscard]] std::uint32_t hash(int x, int y, int z, std::uint32_t seed);

/// Uniform in [0, 1).
[[nodiscard]] float random_unit(int x, int y, std::uint32_t seed);

/// Gradient noise, about [-1, 1], zero mean, with cells of 1. Source: K. Perlin, "Improving Noise", SIGGRAPH 2002.
[[nodiscard]] float noise(const Vec3& p, std::uint32_t seed);

/// Sum of `octaves` of noise, each with about twice the frequency and half the amplitude of the previous one; about
/// [-1, 1].
[[nodiscard]] float fractal_noise(const Vec3& p, int octaves, std::uint32_t seed);

/// Near 1 on thin, branching lines, falling to 0 away from them; used for cracks.
[[nodiscard]] float crack_lines(const Vec3& p, std::uint32_t seed);

/// Marks of a pointed chisel, in [0, 1], on a face with the coordinates `p` in metres: parallel furrows whose direction
/// changes every hand's breadth.
[[nodiscard]] float chisel_marks(const Vec2& p, std::uint32_t seed);

}  // namespace cyclorama::generator
