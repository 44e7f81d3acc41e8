// SPDX-License-Identifier: Apache-2.0
/// Finds the triangles on which light varies more than between their vertices, and samples them on finer grids.
#pragma once

#include <span>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/light_baking/light_tracer.h"

namespace cyclorama::light_baking {

/// The light at a base sample, divided by origin.
struct PointLight {
  LampLight lamps;
  GatheredLight surfaces;
};

/// One side of a placement, with its base samples.
struct LitSide {
  const render::Placement* placement = nullptr;
  bool back = false;
  bool per_triangle = false;
  std::span<const LightPoint> points;  ///< Points of the base samples, on this side.
  std::span<const PointLight> light;
  std::span<const float> lamp_ranges;  ///< See BaseSide::lamp_ranges; empty for samples per triangle.
  bool only_lamps = false;             ///< True for a scene without bounces: light from other surfaces is ignored.
};

/// A triangle to be examined.
struct SeenTriangle {
  std::uint32_t triangle = 0;
  float distance = 0.0f;                                       ///< Distance to the nearest eye in metres.
  render::Vec3 seen_at = render::Vec3::Constant(1.0f / 3.0f);  ///< Weights of a point that the nearest eye sees.
};

/// Minimum visible_parts() for a triangle to be examined for hidden corners. In a smaller triangle, a wrong corner
/// affects only a few pixels, and tracing it would cost more than it gains, because surfaces intersect nearly
/// everywhere.
inline constexpr double kMinBlockedParts = 32.0;

/// Returns the number of samples along the triangle's longest edge that a visitor could distinguish at the nearest eye.
[[nodiscard]] double visible_parts(const render::Placement& placement, const SeenTriangle& seen,
                                   const BakeSettings& settings);

/// The light at a point of a grid; before finished_grid(), only that of lamps.
struct ProbeLight {
  render::Vec3 light = render::Vec3::Zero();
  float error = 0.0f;  ///< Standard error of its luminance.
};

/// A triangle that may get a grid, and the samples that it has so far.
struct GridInWork {
  std::uint32_t triangle = 0;
  int max_parts = 1;           ///< Parts (a power of two) that a visitor could distinguish, within the settings.
  double visible_parts = 1.0;  ///< See visible_parts(); not limited by the settings.
  bool is_smooth = false;      ///< True if the lamps' light hardly varies between and around the corners.
  int parts = 0;               ///< Parts of the grid; 0: only the vertices' samples.
  /// Mean squared error of the interpolation between the samples, without the noise of the measurement, relative to the
  /// light there plus `dim_light`.
  float squared_error = 0.0f;
  bool is_needed = false;  ///< True if the vertices' samples cannot be used, so that paths are traced without a grid.
  bool has_blocked_corner = false;
  bool needs_surfaces = false;  ///< True if light from other surfaces also varies more than between the vertices.
  std::vector<ProbeLight> light{};
  std::vector<std::uint8_t> rough{};  ///< 1 for samples next to which light varies more than linearly.

  /// Returns true if another step could improve the grid.
  [[nodiscard]] bool wants_step() const { return squared_error > 0.0f && parts < max_parts; }
  /// Returns true if the triangle is so large that a few probes cannot rule out a shadow. It always gets a grid.
  [[nodiscard]] bool is_huge() const;
  /// Returns true if the grid or, without one, the vertices are too coarse for the light on the triangle.
  [[nodiscard]] bool is_unresolved() const;
  [[nodiscard]] int next_parts() const;
  /// Returns the number of samples that the next step adds.
  [[nodiscard]] int step_samples() const;
};

/// A finished grid of a triangle. Samples that something separates from a neighbour are marked as unusable.
struct MadeGrid {
  std::uint32_t triangle = 0;
  int parts = 0;
  std::vector<ProbeLight> light;       ///< Light without the ambient light.
  std::vector<std::uint8_t> separate;  ///< 1 for samples that must not be used.
};

/// Returns the triangles for which something hides the middle from a corner, because an object stands on them. Light
/// must not be interpolated between the corners of such a triangle.
[[nodiscard]] std::vector<std::uint32_t> find_blocked(const LitSide& side, std::span<const std::uint32_t> triangles,
                                                      LightTracer& tracer);

// The following functions are thread-bound like their argument `tracer`.

/// Compares the light at points inside the triangles with that of the vertices. Returns the triangles that need a grid.
[[nodiscard]] std::vector<GridInWork> probe_triangles(const LitSide& side, std::span<const SeenTriangle> triangles,
                                                      const BakeSettings& settings, LightTracer& tracer);
/// Makes the first grid of a triangle, or halves the spacing of its samples. If halving improves nothing, the grid is
/// kept and gets no further steps. Precondition: wants_step().
void advance_grid(const LitSide& side, const BakeSettings& settings, LightTracer& tracer, GridInWork* grid);
/// Adds the light from other surfaces to the samples of a grid.
[[nodiscard]] MadeGrid finished_grid(const LitSide& side, const GridInWork& grid, const BakeSettings& settings,
                                     LightTracer& tracer);

}  // namespace cyclorama::light_baking
