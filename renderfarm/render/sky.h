// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::render {

/// Returns the sky's radiance along a unit direction. It is linear in the sine of the elevation, from the horizon up to
/// the zenith and down to the ground.
[[nodiscard]] inline Vec3 sky_radiance(const scene::Sky& sky, const Vec3& direction) {
  const float height = std::clamp(direction.y(), -1.0f, 1.0f);
  const Vec3& end = height >= 0.0f ? sky.zenith : sky.ground;
  return sky.horizon + (end - sky.horizon) * std::abs(height);
}

[[nodiscard]] inline bool shines(const scene::Sky& sky) {
  return sky.zenith.maxCoeff() > 0.0f || sky.horizon.maxCoeff() > 0.0f || sky.ground.maxCoeff() > 0.0f;
}

}  // namespace cyclorama::render
