// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "renderfarm/render/vectors.h"

namespace cyclorama {

inline constexpr float kEndless = std::numeric_limits<float>::infinity();

/// One aim at a light from a place p.
struct LightSample {
  Vec3 direction = Vec3::Zero();  ///< Towards the light, unit length.
  /// A shadow ray from p ends here: just before the light, by the bound of what rounding may do, so that it does not
  /// meet the light itself. Infinite for what is infinitely far.
  float distance = 0.0f;
  Vec3 radiance_over_density = Vec3::Zero();  ///< Times BSDF and cosine it is an unbiased estimate.
  /// Per steradian. 0 where no ray that is aimed at random would meet the light: nothing to weigh it against.
  float density = 0.0f;
};

/// LightSample::distance for a surface at `distance` from p that is met with this cosine. Both ends are rounded, and so
/// is the ray's own arithmetic; on a surface met at a slant that error is as much longer.
[[nodiscard]] inline float short_of(const Vec3& p, float distance, float cosine) {
  constexpr float kRoundings = 32.0f * 0x1p-24f;
  const float error = kRoundings * (2.0f * p.lpNorm<1>() + distance);
  return std::max(0.0f, distance - error / std::max(cosine, kRoundings));
}

}  // namespace cyclorama
