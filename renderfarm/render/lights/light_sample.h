// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

inline constexpr float kEndless = std::numeric_limits<float>::infinity();

/// A sampled position on a light, seen from a point p.
struct LightSample {
  Vec3 direction = Vec3::Zero();  ///< Towards the light, unit length.
  /// Length of a shadow ray from p. It ends short of the light by the bound of the rounding errors, so that the ray
  /// does not hit the light itself. Infinite for lights that are infinitely far.
  float distance = 0.0f;
  Vec3 radiance_over_pdf = Vec3::Zero();  ///< An unbiased estimate once BSDF and cosine multiply it.
  /// Pdf per steradian; 0 if BSDF sampling cannot hit the light, so that its multiple-importance weight is 1.
  float pdf = 0.0f;
  std::size_t group = 0;  ///< Group of the lamp (renderfarm/scene/lamp_groups.h), whose level must multiply the light.
};

/// Returns LightSample::distance for a surface at `distance` from p that the ray hits at an angle whose cosine is
/// `cosine`. Both ends of the ray are rounded, and so is the arithmetic of tracing it; at oblique incidence the error
/// grows by 1 / cosine.
[[nodiscard]] inline float short_of(const Vec3& p, float distance, float cosine) {
  constexpr float kRoundings = 32.0f * 0x1p-24f;
  const float error = kRoundings * (2.0f * p.lpNorm<1>() + distance);
  return std::max(0.0f, distance - error / std::max(cosine, kRoundings));
}

}  // namespace cyclorama::render
