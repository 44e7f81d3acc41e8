// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/figures.h"
#include "renderfarm/generator/motifs.h"

namespace cyclorama::generator {

Patch nimbus_disc(const Pose& pose, const Vec2& radii, int scheme, float density) {
  Patch patch;
  patch.width_m = 2.0f * radii.x() * pose.scale;
  patch.height_m = 2.0f * radii.y() * pose.scale;
  patch.density = density;
  patch.at = [pose, radii, scheme](float u, float v, float spacing) {
    // Maps a square to a disc without a pole. Source: M. Fong, "Analytical methods for squaring the disc", 2014.
    const float x = 2.0f * u - 1.0f;
    const float y = 2.0f * v - 1.0f;
    const Vec2 disc{x * std::sqrt(1.0f - 0.5f * y * y), y * std::sqrt(1.0f - 0.5f * x * x)};
    const float r = disc.norm();
    const Vec3 p{disc.x() * radii.x(), disc.y() * radii.y(), 0.05f * radii.minCoeff() * r * r};
    const float metres = radii.minCoeff() * pose.scale;
    return Surfel{pose.to_room(p), nimbus(r, std::atan2(disc.x(), disc.y()), metres, scheme, spacing)};
  };
  turn_towards(patch, pose.to_room(Vec3::UnitZ()));
  return patch;
}

}  // namespace cyclorama::generator
