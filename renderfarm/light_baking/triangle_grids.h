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
  GatheredLight surfaces;
};

/// A side of a placement with its base samples.
struct LitSide {
  const render::Placement* placement = nullptr;
  bool back = false;
  bool per_triangle = false;
  std::span<const LightPoint> points;  ///< Points of the base samples, on this side.
  std::span<const PointLight> light;
  bool only_lamps = false;  ///< True if light from other surfaces does not count: a scene without bounces.
};

/// A triangle to look at.
struct SeenTriangle {
  std::uint32_t triangle = 0;
  float distance = 0.0f;  ///< Metres to the nearest eye.
};

/// Triangles with fewer visible parts are so small that a wrong corner spoils a few pixels only; tracing them instead
/// would cost more than it mends, because intersecting surfaces are everywhere.
inline constexpr double kMinBlockedParts = 32.0;

/// Returns the number of samples along the triangle's longest edge that its nearest visitor could tell apart.
[[nodiscard]] double visible_parts(const render::Placement& placement, const SeenTriangle& seen,
                                   const BakeSettings& settings);

/// The samples of a triangle: of a grid, without those that something separates from a neighbour.
struct MadeGrid {
  std::uint32_t triangle = 0;
  int parts = 0;
  std::vector<render::Vec3> light;     ///< Without the ambient light.
  std::vector<std::uint8_t> separate;  ///< 1 for samples that must not be used.
};

/// Sets 1 for triangles whose corners do not see their middle, because something stands on them, and 0 for others:
/// between such corners light must not be interpolated. `ret` is for triangles from `first` on.
void find_blocked(const LitSide& side, std::uint32_t first, LightTracer& tracer, std::span<std::uint8_t> ret);

/// Returns grids for those of `triangles` that need one. Thread-bound by `tracer`.
[[nodiscard]] std::vector<MadeGrid> make_grids(const LitSide& side, std::span<const SeenTriangle> triangles,
                                               const BakeSettings& settings, LightTracer& tracer);

}  // namespace cyclorama::light_baking
