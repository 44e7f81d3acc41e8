// SPDX-License-Identifier: Apache-2.0
/// The lamp at the visitor's eye: a fill light, which lights what the eye sees, directly, in mirrors and through glass.
///
/// It gives surfaces no indirect light, because then all light would change with every step of the visitor. As it is,
/// the light of all other lamps can be computed ahead, and that of the eye lamp costs no ray where the eye sees a
/// surface directly: shadows are hidden from the eye by the objects that cast them.
#pragma once

#include <algorithm>
#include <cmath>

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// The eye lamp, seen from a point of a surface.
struct EyeLampLight {
  Vec3 direction = Vec3::UnitY();  ///< To the lamp. Unit length.
  float distance = 0.0f;           ///< In metres.
  Vec3 irradiance = Vec3::Zero();  ///< On a surface that faces the lamp.
};

/// Returns the light at `position`. `wo` is the direction if the lamp is at the same place. All in the render frame.
[[nodiscard]] inline EyeLampLight eye_lamp_at(const Vec3& eye_lamp, const Vec3& eye, const Vec3& position,
                                              const Vec3& wo) {
  // Limits the light on near surfaces, because the lamp is beside the eye, not at it.
  constexpr float kMinDistance2 = 0.05f * 0.05f;
  const Vec3 offset = eye - position;
  const float distance2 = std::max(offset.squaredNorm(), kMinDistance2);
  return {normalized_or(offset, wo), std::sqrt(distance2), eye_lamp / distance2};
}

}  // namespace cyclorama::render
