// SPDX-License-Identifier: Apache-2.0
/// Where a group of lights is, where it shines and how strongly: what a choice among groups is made by.
#pragma once

#include <cstdint>
#include <limits>

#include "renderfarm/render/vectors.h"

namespace cyclorama {

/// A cone of directions: all within the angle whose cosine is `cosine`. 1: `axis` alone; -1: all.
struct DirectionCone {
  Vec3 axis = Vec3::UnitY();
  float cosine = 2.0f;  ///< Above 1: none.

  [[nodiscard]] bool empty() const { return cosine > 1.0f; }
  void extend(const DirectionCone& other);
};

/// Source: Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018.
struct LightBounds {
  Vec3 low = Vec3::Constant(std::numeric_limits<float>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<float>::infinity());
  DirectionCone normals;       ///< Of the surfaces that shine.
  float cos_emission = 1.0f;   ///< Cosine of how far from its normal each shines: 0 for surfaces.
  float power = 0.0f;          ///< Candela (luminance) along the normal; of all together the sum.
  float inverse_range = 0.0f;  ///< Of the farthest; 0 is without end.

  void extend(const LightBounds& other);
  [[nodiscard]] Vec3 centre() const { return 0.5f * low + 0.5f * high; }
  [[nodiscard]] float radius() const { return 0.5f * (high - low).norm(); }
};

}  // namespace cyclorama
