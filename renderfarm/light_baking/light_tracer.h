// SPDX-License-Identifier: Apache-2.0
/// Estimates the light at points of surfaces with the renderer's own rays, materials and lamps.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "renderfarm/light_baking/light_points.h"
#include "renderfarm/render/kernel.h"

namespace cyclorama::light_baking {

/// Irradiance at a point over pi, divided by its origin. The sum of both, plus the scene's ambient light, is what a
/// sample stores. Light of a lamp may be found by a shadow ray or by a scattered ray that hits it; each counts with the
/// weight of the power heuristic, so `lamps` alone is not all direct light.
struct LampLight {
  render::Vec3 light = render::Vec3::Zero();
  render::Vec3 direction = render::Vec3::Zero();  ///< Sum of directions, each weighted by the luminance from there.
  float error = 0.0f;                             ///< Standard error of its luminance.
};

struct GatheredLight {
  render::Vec3 light = render::Vec3::Zero();
  render::Vec3 direction = render::Vec3::Zero();  ///< The same sum as in LampLight.
};

struct TracerSettings {
  int max_light_rays = 256;
  float light_error = 0.01f;
};

/// Traces for one thread at a time. The scene and the stage are borrowed.
class LightTracer {
 public:
  LightTracer(const render::TraceScene& scene, render::ShadeStage shade, int bounces);

  /// Estimates the light that comes straight from lamps and the sky, by shadow rays: at least 16 for each point, then
  /// more until the standard error is below `light_error` of the light or there are `max_light_rays`. Points that do
  /// not exist get none.
  void from_lamps(std::span<const LightPoint> points, const TracerSettings& settings, std::span<LampLight> ret);

  /// Estimates all other light, from `rays` scattered rays per point, which read the stored light of the surfaces that
  /// they hit, as far as it has been computed. With `only_lamps` they collect the light of lamps alone. Precondition:
  /// `rays` is a power of two up to render::kMaxRays.
  void from_surfaces(std::span<const LightPoint> points, int rays, bool only_lamps, std::span<GatheredLight> ret);

  /// Sets 1 for each pair of points with nothing between them, otherwise 0.
  void find_visible(std::span<const std::array<render::Vec3, 2>> pairs, std::span<std::uint8_t> ret);

 private:
  void add_light_ray(const LightPoint& point, std::uint32_t number, std::size_t path);

  const render::TraceScene& scene_;
  const render::ShadeStage shade_;
  render::TraceView view_;
  std::unique_ptr<render::PathBatch> batch_;
  std::vector<render::Vec3> directions_;    ///< Direction in which each path of the batch starts.
  std::unique_ptr<render::CellFilm> film_;  ///< Required by the kernels; its contents are not used.
};

}  // namespace cyclorama::light_baking
