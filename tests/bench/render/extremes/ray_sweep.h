// SPDX-License-Identifier: Apache-2.0
/// Rays against geometry far from the render frame's origin, where float is coarse. Only the position of the geometry
/// differs; nothing is rebased.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/base/result.h"

namespace cyclorama {

/// Maximum fraction of rays that may escape from a closed sphere.
inline constexpr double kMaxLeakFraction = 2e-5;

struct LeakCount {
  std::uint64_t rays = 0;
  std::uint64_t leaks = 0;      ///< Rays from the centre, or continued from those hits, that hit nothing.
  std::uint64_t self_hits = 0;  ///< Rays from a hit that hit its own triangle.
};

/// Counts for a sphere of radius 10 m about `centre`, baked.
Result<LeakCount> count_leaks(const Eigen::Vector3d& centre, int rays);

struct SelfHitCount {
  std::uint64_t rays = 0;
  std::uint64_t self_hits = 0;             ///< Starting at start_off_surface().
  std::uint64_t self_hits_fixed_near = 0;  ///< Starting at the hit itself, ignoring hits nearer than 1e-4.
};

/// Counts for random triangles of some metres, or of a millionth of `coordinate`, about (1, 1, 1) * `coordinate`: rays
/// towards them, and from there in all directions.
Result<SelfHitCount> count_self_hits(double coordinate, int rays);

}  // namespace cyclorama
