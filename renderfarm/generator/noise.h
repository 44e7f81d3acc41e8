// SPDX-License-Identifier: Apache-2.0
/// Repeatable randomness: pure functions of position and seed, so that the result does not depend on the thread that
/// computes a row.
#pragma once

#include <cstdint>

#include "renderfarm/generator/vec.h"

namespace cyclorama::generator {

/// Hashes the integers so that neighbouring inputs give unrelated values.
[[nodiscard]] std::uint32_t hash(int x, int y, int z, std::uint32_t seed);

/// Returns a random number that is uniform in [0, 1).
[[nodiscard]] float random_unit(int x, int y, std::uint32_t seed);

/// Returns gradient noise in about [-1, 1], with zero mean and cells of size 1. Source: K. Perlin, "Improving Noise",
/// SIGGRAPH 2002.
[[nodiscard]] float noise(const Vec3& p, std::uint32_t seed);

/// Returns the sum of `octaves` octaves of noise, each with about twice the frequency and half the amplitude of the
/// previous one; in about [-1, 1].
[[nodiscard]] float fractal_noise(const Vec3& p, int octaves, std::uint32_t seed);

/// Returns 1 on thin, branching lines and 0 away from them; used for cracks.
[[nodiscard]] float crack_lines(const Vec3& p, std::uint32_t seed);

/// Returns the marks of a pointed chisel, in [0, 1], on a face with the coordinates `p` in metres: parallel furrows
/// whose direction changes about every half metre.
[[nodiscard]] float chisel_marks(const Vec2& p, std::uint32_t seed);

}  // namespace cyclorama::generator
