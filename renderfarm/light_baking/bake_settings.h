// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "renderfarm/light_baking/light_tracer.h"

namespace cyclorama::light_baking {

/// Upper bound of the rays of a sample.
inline constexpr int kMaxRaysOfSample = 1 << 14;

/// Settings that trade the cost of computing light against its accuracy. docs/design/stored-light.md has measurements.
struct BakeSettings {
  int eyes = 64;  ///< Positions in the walkable area from which the surfaces that visitors see are found.
  int rays_per_eye = 1 << 18;
  /// Resolution of the wall, which determines how fine light must be where visitors can come close.
  double pixels_per_degree = 20.0;
  double pixels_per_sample = 4.0;  ///< Spacing of the finest samples, in pixels of the nearest eye.
  int max_light_rays = 64;         ///< Maximum shadow rays of a base sample; fewer are traced if they agree.
  double light_error = 0.01;       ///< Relative standard error of direct light below which no more rays are traced.
  int max_grid_light_rays = 32;    ///< The two limits for samples of grids, which are closer together:
  double grid_light_error = 0.03;
  int coarse_rays = 8;  ///< Rays of a sample for each bounce before the last.
  int final_rays = 64;  ///< Rays of a sample for the last bounce, which the visitor sees.
  /// Lower bound of the rays of all samples together, for the last bounce, for the grids and for lamps; a quarter of it
  /// for each bounce before. Scenes of few triangles have few samples, whose noise would be seen.
  std::int64_t min_rays = std::int64_t{1} << 24;
  /// Standard error of light from other surfaces at which no more of these rays are traced, relative to the light and
  /// `dim_light`: about a third of a code of the picture.
  double surface_error = 0.01;
  /// Error between the vertices above which a triangle may get a grid, relative to the light there and `dim_light`.
  double probe_error = 0.02;
  float dim_light = 0.0f;  ///< Radiance that looks dark on the wall. bake_light() sets it from the scene's exposure.
  int max_parts = 128;     ///< Maximum parts of a grid along an edge; a power of two up to 256.
  /// Budget for all samples: bytes per triangle of the scene, at least `min_bytes` in total. Grids are made where they
  /// reduce the error most.
  double bytes_per_triangle = 12.0;
  std::uint64_t min_bytes = std::uint64_t{4} << 20;
  /// Total budget, if it is more, where the rest is for triangles on which paths would be traced otherwise, such as
  /// floors of two triangles: a scene of few triangles may consist of them.
  std::uint64_t resolving_bytes = std::uint64_t{12} << 20;
  /// Processor time in seconds after which no more grids are made; 0: no limit. With a limit, the result depends on the
  /// host.
  double max_cpu_seconds = 0.0;
  std::uint64_t seed = 1;
  int check_eyes = 32;  ///< Held-out eyes from which the result is compared with path tracing; 0: none.

  /// Returns the number of rays per sample: an equal share of min_rays / `divisor` for each of `samples` samples,
  /// rounded down to a power of two and limited to kMaxRaysOfSample, but never less than `rays`.
  [[nodiscard]] int rays_of(int rays, std::uint64_t samples, int divisor) const;
  [[nodiscard]] GatherSettings gathering(int rays, int bounces) const {
    return {rays, bounces, static_cast<float>(surface_error), dim_light};
  }
};

}  // namespace cyclorama::light_baking
