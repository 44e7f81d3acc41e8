// SPDX-License-Identifier: Apache-2.0
/// Estimates the light at points of surfaces with the renderer's own rays, materials and lamps.
#pragma once

#include <array>
#include <functional>
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

struct GatherSettings {
  int rays = 0;     ///< Rays of a spot; from render::kMaxRays on, fewer once their standard error is small enough.
  int bounces = 0;  ///< Bounces that are traced where the scene has no light. Without any, rays find lamps alone.
  /// Standard error that is small enough, relative to the light and `dim_light`. Errors are known from 16 rays on.
  float error = 0.0f;
  float dim_light = 0.0f;
};

/// Traces for one thread at a time. The scene and the stage are borrowed. Rays of one packet start at consecutive spots
/// and take about the same way, so spots that follow one another should be neighbours.
class LightTracer {
 public:
  /// `must_end` is called before each batch of rays; once it returns true, results are incomplete. It may be null.
  /// `lamps` are the levels of the lamps' groups.
  LightTracer(const render::TraceScene& scene, render::ShadeStage shade, std::function<bool()> must_end = nullptr,
              const scene::LampLevels& lamps = scene::kAuthoredLamps);

  /// To be called by a thread when it begins a piece of work.
  void begin_run();
  /// Returns true if the thread must end its work. The tracer calls it before each batch of rays.
  bool must_end();
  /// Returns the longest processor time, in seconds, between two of these calls.
  [[nodiscard]] double max_run() const { return max_run_; }

  /// Estimates the light that comes directly from lamps and the sky, by shadow rays. Each spot gets at least 16 rays,
  /// then more until the standard error is below `light_error` of the light or there are `max_light_rays`. A spot that
  /// no light reaches gets up to 64. Spots that do not exist get none.
  void from_lamps(std::span<const LightSpot> spots, const TracerSettings& settings, std::span<LampLight> ret);

  /// Estimates all other light, by scattered rays, which read the light that the scene has at present where they
  /// arrive. Precondition: `settings.rays` is a power of two.
  void from_surfaces(std::span<const LightSpot> spots, GatherSettings settings, std::span<GatheredLight> ret);

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
  /// Takes rays `first_ray` to `first_ray` + `rays` of each spot; at most render::kMaxRays.
  void gather(std::span<const LightSpot> spots, int first_ray, int rays, int bounces, std::span<GatheredLight> ret);
  /// Doubles the rays of the `active` spots, of which `done` have been taken.
  void add_rays(std::span<const LightSpot> spots, std::span<const std::uint32_t> active, int done, int bounces,
                std::span<GatheredLight> ret);
  void begin(const LightSpot& spot, std::uint32_t number, std::size_t path);
  void add_light_ray(std::size_t path);
  void add_scattered_ray(bool only_lamps, float spread, std::size_t path);

  const render::TraceScene& scene_;
  const render::ShadeStage shade_;
  const std::function<bool()> must_end_;
  double run_began_ = 0.0;
  double max_run_ = 0.0;
  render::TraceView view_;
  std::unique_ptr<render::PathBatch> batch_;
  std::vector<render::Vec3> directions_;  ///< Direction in which each path of the batch starts.
  std::vector<Start> starts_;             ///< The start of each path of the batch.
  std::vector<std::uint8_t> part_;        ///< Class of similar ways to which each path belongs, below kParts.
  std::vector<std::uint16_t> order_;
  std::unique_ptr<render::CellFilm> film_;  ///< Required by the kernels; its contents are not used.
};

}  // namespace cyclorama::light_baking
