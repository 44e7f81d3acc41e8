// SPDX-License-Identifier: Apache-2.0
/// Rays against geometry far from the render frame's origin, where float is coarse. Only the geometry's place differs:
/// nothing is rebased.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/base/result.h"

namespace cyclorama {

/// The most rays that may escape from a closed sphere, as a part of all.
inline constexpr double kMostLeaks = 2e-5;

struct LeakCount {
  std::uint64_t rays = 0;
  std::uint64_t leaks = 0;      ///< From the centre, or on from where those rays hit, that met nothing.
  std::uint64_t self_hits = 0;  ///< Rays from a hit that met its own triangle.
};

/// A sphere of 10 m about `centre`, baked.
Result<LeakCount> count_leaks(const Eigen::Vector3d& centre, int rays);

struct SelfHitCount {
  std::uint64_t rays = 0;
  std::uint64_t self_hits = 0;             ///< From start_off_surface().
  std::uint64_t self_hits_fixed_near = 0;  ///< From the hit itself, nothing nearer than 1e-4 counted.
};

/// Random triangles of some metres, or of a millionth of `coordinate`, about (1, 1, 1) * `coordinate`; rays at them,
/// and on from there to all sides.
Result<SelfHitCount> count_self_hits(double coordinate, int rays);

}  // namespace cyclorama
