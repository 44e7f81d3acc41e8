// SPDX-License-Identifier: Apache-2.0
/// Finds the triangles on which light varies more than between their vertices, and samples them finely.
#pragma once

#include <span>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/light_baking/light_tracer.h"

namespace cyclorama::light_baking {

/// The light at a base sample, in parts.
struct PointLight {
  LampLight lamps;
  render::Vec3 surfaces = render::Vec3::Zero();
};

/// A side of a placement with its base samples.
struct LitSide {
  const render::Placement* placement = nullptr;
  bool back = false;
  bool per_triangle = false;
  std::span<const LightPoint> points;  ///< Points of the base samples, on this side.
  std::span<const PointLight> light;
};

/// A triangle to look at.
struct SeenTriangle {
  std::uint32_t triangle = 0;
  float distance = 0.0f;  ///< Metres to the nearest eye.
};

/// The samples of a triangle: of a grid, without those that something separates from a neighbour.
struct MadeGrid {
  std::uint32_t triangle = 0;
  int parts = 0;
  std::vector<render::Vec3> light;     ///< Without the ambient light.
  std::vector<std::uint8_t> separate;  ///< 1 for samples that must not be used.
};

/// Returns grids for those of `triangles` that need one. Thread-bound by `tracer`.
[[nodiscard]] std::vector<MadeGrid> make_grids(const LitSide& side, std::span<const SeenTriangle> triangles,
                                               const BakeSettings& settings, LightTracer& tracer);

}  // namespace cyclorama::light_baking
