// SPDX-License-Identifier: Apache-2.0
/// Bounds of a group of lights in position, direction and power, used to choose among groups.
#pragma once

#include <cstdint>
#include <limits>

#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// A cone of directions around `axis`. `cosine` is that of its half angle: 1 for the axis alone, -1 for all directions.
struct DirectionCone {
  Vec3 axis = Vec3::UnitY();
  float cosine = 2.0f;  ///< Greater than 1 for the empty cone.

  [[nodiscard]] bool empty() const { return cosine > 1.0f; }
  void extend(const DirectionCone& other);
};

/// Bounds of one light or a group of them. Source: Conty Estevez and Kulla, "Importance Sampling of Many Lights with
/// Adaptive Tree Splitting", 2018.
struct LightBounds {
  Vec3 low = Vec3::Constant(std::numeric_limits<float>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<float>::infinity());
  DirectionCone normals;       ///< Normals of the emitting surfaces.
  float cos_emission = 1.0f;   ///< Cosine of the greatest emission angle from a normal: 0 for surfaces.
  float power = 0.0f;          ///< Candela (luminance) along the normal; for a group, the sum.
  float inverse_range = 0.0f;  ///< Inverse of the longest range, in 1/m; 0 for no limit.

  void extend(const LightBounds& other);
  [[nodiscard]] Vec3 centre() const { return 0.5f * low + 0.5f * high; }
  [[nodiscard]] float radius() const { return 0.5f * (high - low).norm(); }
};

}  // namespace cyclorama::render
