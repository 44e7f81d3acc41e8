// SPDX-License-Identifier: Apache-2.0
/// Finds the triangles on which light varies more than between their vertices, and samples them on finer grids.
#pragma once

#include <span>
#include <vector>

#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/light_baking/grid_light.h"
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
  std::span<const float> lamp_ranges;     ///< See BaseSide; empty for samples per triangle.
  std::span<const std::uint8_t> misread;  ///< See BaseSide; empty until it is known.
  int bounces = 0;                        ///< Bounces of the scene; see LightTracer::from_surfaces().
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

/// Mean error of the light of lamps on a triangle, relative to that light, beyond which bounces do not interpolate it.
inline constexpr float kMaxMisread = 0.01f;

/// Returns the number of samples along the triangle's longest edge that its nearest visitor could tell apart.
[[nodiscard]] double visible_parts(const render::Placement& placement, const SeenTriangle& seen,
                                   const BakeSettings& settings);

/// A triangle that may get a grid, with the samples that it has so far.
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
  bool needs_surfaces = false;  ///< Light from other surfaces, too, varies more than between the vertices.
  bool is_misread = false;      ///< The vertices misstate the light of lamps; see find_misread().
  std::vector<ProbeLight> light{};
  std::vector<std::uint8_t> rough{};  ///< 1 for samples next to which light varies more than linearly.

  /// Returns true if another step could improve the grid.
  [[nodiscard]] bool wants_step() const { return squared_error > 0.0f && parts < max_parts; }
  /// Returns true if the triangle is so large that a few probes cannot rule out a shadow. It always gets a grid.
  [[nodiscard]] bool is_huge() const;
  /// Returns true if it is to be expected that light from other surfaces varies between its corners.
  [[nodiscard]] bool is_uneven() const { return is_huge() || is_misread; }
  /// Returns true if its grid, or the vertices without one, is too coarse to show the light that varies on it.
  [[nodiscard]] bool is_unresolved() const;
  [[nodiscard]] int next_parts() const;
  /// Returns the parts of the grid on which light from other surfaces is sampled, unless the vertices have it.
  [[nodiscard]] int surface_parts() const;
  /// Returns the samples that the next step adds.
  [[nodiscard]] int step_samples() const;
};

/// Returns those triangles of which a corner does not see the middle, because something stands on them: between such
/// corners light must not be interpolated.
[[nodiscard]] std::vector<std::uint32_t> find_blocked(const LitSide& side, std::span<const std::uint32_t> triangles,
                                                      LightTracer& tracer);

/// A triangle with the number of points at which its light is to be compared with that of its vertices.
struct ProbedTriangle {
  std::uint32_t triangle = 0;
  int probes = 0;
};

// The following functions are thread-bound, like their argument `tracer`:

/// Returns those triangles whose vertices misstate the light of lamps between them by more than kMaxMisread in the
/// mean. Rays that bounce must not interpolate it there.
[[nodiscard]] std::vector<std::uint32_t> find_misread(const LitSide& side, std::span<const ProbedTriangle> triangles,
                                                      const BakeSettings& settings, LightTracer& tracer);

/// Compares light at points inside the triangles with that of their vertices, and returns those that need a grid.
[[nodiscard]] std::vector<GridInWork> probe_triangles(const LitSide& side, std::span<const SeenTriangle> triangles,
                                                      const BakeSettings& settings, LightTracer& tracer);
/// Makes the first grid of a triangle, or halves the spacing of its samples. If halving improves nothing, the grid is
/// kept and gets no further steps. Precondition: wants_step().
void advance_grid(const LitSide& side, const BakeSettings& settings, LightTracer& tracer, GridInWork* grid);
/// Adds the light from other surfaces to a grid that has samples. If that light varies more finely, an uneven triangle
/// gets more samples, up to `max_samples`.
[[nodiscard]] MadeGrid finished_grid(const LitSide& side, const GridInWork& grid, int max_samples,
                                     const BakeSettings& settings, LightTracer& tracer);

}  // namespace cyclorama::light_baking
