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

/// Irradiance at a point over pi, divided by its origin into LampLight and GatheredLight. A sample stores the sum of
/// both and the scene's ambient light. A lamp may be found by a shadow ray or by a scattered ray that hits it. Each
/// contributes with the weight of the power heuristic, so LampLight alone is not all direct light.
struct LampLight {
  render::Vec3 light = render::Vec3::Zero();
  render::Vec3 direction = render::Vec3::Zero();  ///< Sum of directions, each weighted by the luminance from it.
  float error = 0.0f;                             ///< Standard error of the luminance of `light`.
};

struct GatheredLight {
  render::Vec3 light = render::Vec3::Zero();
  render::Vec3 direction = render::Vec3::Zero();  ///< See LampLight::direction.
  float error = 0.0f;                             ///< Standard error of the luminance of `light`.
};

struct TracerSettings {
  int max_light_rays = 256;
  float light_error = 0.01f;
};

/// Traces rays on one thread. Keeps references to the scene and the stage. Rays of one packet start at consecutive
/// spots and should take similar ways, so consecutive spots should be close to each other.
class LightTracer {
 public:
  LightTracer(const render::TraceScene& scene, render::ShadeStage shade, int bounces);

  /// Estimates the light that comes directly from lamps and the sky, by shadow rays. Each spot gets at least 16 rays,
  /// then more until the standard error is below `light_error` of the light or there are `max_light_rays`. A spot that
  /// no light reaches gets up to 64. Spots that do not exist get none.
  void from_lamps(std::span<const LightSpot> spots, const TracerSettings& settings, std::span<LampLight> ret);

  /// Estimates all other light from `rays` scattered rays per spot. Where the rays arrive, they use the scene's present
  /// light. With `only_lamps`, they find only lamps. Errors are known from 16 rays on. Precondition: `rays` is a power
  /// of two up to render::kMaxRays.
  void from_surfaces(std::span<const LightSpot> spots, int rays, bool only_lamps, std::span<GatheredLight> ret);

  /// Sets 1 for each pair of points with nothing between them, and 0 for other pairs.
  void find_visible(std::span<const std::array<render::Vec3, 2>> pairs, std::span<std::uint8_t> ret);
  /// Sets, for each pair, the unobstructed fraction of the line from its first point to its second.
  void find_free_share(std::span<const std::array<render::Vec3, 2>> pairs, std::span<float> ret);

 private:
  /// The random decisions of a ray that is about to start.
  struct Start {
    const LightPoint* from = nullptr;
    std::uint32_t index = 0;  ///< Number of its sample, bit-reversed.
    std::uint32_t seed = 0;
    float u = 0.0f;
    float v = 0.0f;
  };
  /// Returns the numbers of the first `count` starts, sorted by `part_`.
  [[nodiscard]] std::span<const std::uint16_t> by_part(std::size_t count);
  void begin(const LightSpot& spot, std::uint32_t number, std::size_t path);
  void add_light_ray(std::size_t path);
  void add_scattered_ray(bool only_lamps, float spread, std::size_t path);

  const render::TraceScene& scene_;
  const render::ShadeStage shade_;
  render::TraceView view_;
  std::unique_ptr<render::PathBatch> batch_;
  std::vector<render::Vec3> directions_;  ///< Direction in which each path of the batch starts.
  std::vector<Start> starts_;             ///< The start of each path of the batch.
  std::vector<std::uint8_t> part_;        ///< Class of similar ways to which each path belongs, below kParts.
  std::vector<std::uint16_t> order_;
  std::unique_ptr<render::CellFilm> film_;  ///< Required by the kernels; its contents are not used.
};

}  // namespace cyclorama::light_baking
