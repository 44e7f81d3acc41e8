// SPDX-License-Identifier: Apache-2.0
/// Fresnel reflectance of smooth surfaces. Reentrant.
#pragma once

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Returns Schlick's weight of the reflectance at grazing angles.
[[nodiscard]] inline float schlick(float cosine) {
  const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
  const float m2 = m * m;
  return m2 * m2 * m;
}

/// The mean of f0 + (f90 - f0) * schlick over a cosine-weighted hemisphere.
inline constexpr float kMeanSchlick = 1.0f / 21.0f;

/// Returns the unpolarised Fresnel reflectance and sets `ret_cosine` to the cosine of the refracted direction. `eta` is
/// the index of refraction beyond the surface divided by the index before it; `cosine` > 0 is the cosine of the
/// incident direction. Under total reflection the results are 1 and 0.
[[nodiscard]] inline float dielectric_reflectance(float cosine, float eta, float* ret_cosine) {
  const float sine2 = std::max(0.0f, 1.0f - cosine * cosine) / (eta * eta);
  *ret_cosine = 0.0f;
  if (sine2 >= 1.0f) return 1.0f;
  const float beyond = std::sqrt(1.0f - sine2);
  *ret_cosine = beyond;
  const float parallel = (eta * cosine - beyond) / (eta * cosine + beyond);
  const float across = (cosine - eta * beyond) / (cosine + eta * beyond);
  return 0.5f * (parallel * parallel + across * across);
}

}  // namespace cyclorama::render
