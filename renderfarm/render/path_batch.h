// SPDX-License-Identifier: Apache-2.0
/// Paths that are traced together, stage by stage: all camera rays, all their surfaces, all shadow rays, all next rays.
/// Whole stages keep the caches warm and give Embree full packets.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "renderfarm/render/ray_queue.h"

namespace cyclorama::render {

/// One sample of one pixel, starting at the eye.
struct Path {
  Vec3 direct = Vec3::Zero();  ///< Radiance so far that the visible surface emits or reflects directly from a light.
  Vec3 indirect = Vec3::Zero();      ///< Radiance of all longer paths.
  std::uint32_t index_reversed = 0;  ///< Identifies the path's random numbers, together with `seed`; see sampler.h.
  std::uint32_t seed = 0;
  int pixel = 0;  ///< Index of the pixel in the cell.
};

/// The most recent ray of a path.
struct PathRay {
  Vec3 throughput = Vec3::Ones();
  /// Pdf of its direction, per steradian; 0 if light sampling could not have chosen it (camera ray, mirror).
  float pdf = 0.0f;
  Vec3 from_normal = Vec3::Zero();  ///< Normal at its start; used with `pdf` to weight hits against light sampling.
  float cone_width = 0.0f;          ///< Width of the sample's cone at its start, in metres.
  Vec3 absorption = Vec3::Zero();   ///< Per metre, of the medium that the ray crosses.
  float cone_spread = 0.0f;         ///< Spread of the cone, in radians.
  std::uint16_t path = 0;
  std::uint8_t scatterings = 0;  ///< Number of scatterings so far at surfaces that are neither mirror nor clear.
  std::uint8_t surfaces = 0;     ///< Number of surfaces of any kind that the path has met.
  /// Value of `surfaces` where the ray's direction was chosen: panes (pane.h) on the way change neither this value nor
  /// `pdf`.
  std::uint8_t aimed_surfaces = 0;
  bool only_light = false;  ///< The ray collects only emitted light; the path ends at the first hit that is not a pane.
  float passed_m = 0.0f;    ///< Distance from the point where its direction was chosen to its start.
};

/// Contribution of a shadow ray if it is unoccluded.
struct ShadowedLight {
  Vec3 light = Vec3::Zero();
  std::uint16_t path = 0;
  bool direct = true;
};

/// Random numbers of every ray in flight, for one surface.
struct SurfaceRandomNumbers {
  using Values = std::array<float, kMaxRays>;
  Values light, through;        ///< Choice of the light, and Russian roulette.
  Values place_u, place_v;      ///< Position on the light.
  Values scatter_u, scatter_v;  ///< Direction of the next ray.
  Values lobe, spare;
};

/// Output of RayCamera::rays().
struct EyeRays {
  std::array<std::array<float, kMaxRays>, 3> origin;
  std::array<std::array<float, kMaxRays>, 3> direction;
  std::array<float, kMaxRays> cone;
  std::array<std::uint8_t, kMaxRays> exists;
};

/// The rays of all active paths, each with its state.
struct RayStage {
  RayQueue<RTCRayHit16> rays;
  std::array<PathRay, kMaxRays> state;
};

/// Working memory of one thread, about 500 kB, kept between cells. Thread-bound.
struct PathBatch {
  int paths = 0;
  std::array<Path, kMaxRays> path;
  std::array<RayStage, 2> stages;
  int stage = 0;  ///< Index of the stage in flight; the next rays are collected in the other stage.
  RayQueue<RTCRay16> shadow_rays;
  std::array<ShadowedLight, kMaxRays> shadowed;
  std::unique_ptr<RayQueue<RTCRayHit16>> pane_rays;    ///< Shadow rays that cross panes; null until there are any.
  std::array<std::uint32_t, kMaxRays> index_reversed;  ///< Path::index_reversed of each ray's path.
  std::array<std::uint32_t, kMaxRays> seed;
  SurfaceRandomNumbers random_numbers;
  EyeRays eye_rays;
  std::uint64_t rays_traced = 0;

  [[nodiscard]] RayStage& current() { return stages[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] RayStage& next() { return stages[static_cast<std::size_t>(1 - stage)]; }
};

}  // namespace cyclorama::render
