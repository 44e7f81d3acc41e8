// SPDX-License-Identifier: Apache-2.0
/// Paths that are traced together, stage by stage: all eye rays, then all their surfaces, all shadow rays, all next
/// rays. Whole stages keep code and vectors warm, and let rays go to Embree in packets.
#pragma once

#include <array>
#include <cstdint>

#include "renderfarm/render/ray_queue.h"

namespace cyclorama {

/// One sample of one pixel, from the eye on.
struct Path {
  Vec3 direct = Vec3::Zero();        ///< Radiance found so far: shone by, or reflected once by what the eye sees.
  Vec3 indirect = Vec3::Zero();      ///< The rest.
  std::uint32_t index_reversed = 0;  ///< Names its random numbers, with `seed`; see sampler.h.
  std::uint32_t seed = 0;
  int pixel = 0;  ///< Of the cell.
};

/// A path's newest ray.
struct PathRay {
  Vec3 throughput = Vec3::Ones();
  float density = 0.0f;  ///< Per solid angle, of its direction; 0 where only this way could be taken (eye, mirror).
  Vec3 from_normal =
      Vec3::Zero();                ///< Where it starts; with `density`, for weighing against lights that were aimed at.
  float cone_width = 0.0f;         ///< Of the sample's cone at its start, metres.
  Vec3 absorption = Vec3::Zero();  ///< Per metre, of what it runs through.
  float cone_spread = 0.0f;        ///< Radians.
  std::uint16_t path = 0;
  std::uint8_t scatterings = 0;  ///< At surfaces that are neither mirror nor clear.
  std::uint8_t surfaces = 0;     ///< Of any kind.
  bool only_light = false;       ///< Looks for light; whatever else it hits ends it.
};

/// What a shadow ray brings if nothing is in its way.
struct ShadowedLight {
  Vec3 light = Vec3::Zero();
  std::uint16_t path = 0;
  bool direct = true;
};

/// Random numbers of every ray in flight, for one surface.
struct SurfaceLots {
  using Values = std::array<float, kMostRays>;
  Values light, through;        ///< Which light, and whether to go on.
  Values place_u, place_v;      ///< Where on the light.
  Values scatter_u, scatter_v;  ///< Whereto next.
  Values lobe, spare;
};

/// What a Camera gives.
struct EyeRays {
  std::array<std::array<float, kMostRays>, 3> origin;
  std::array<std::array<float, kMostRays>, 3> direction;
  std::array<float, kMostRays> cone;
  std::array<std::uint8_t, kMostRays> exists;
};

/// The rays of all paths that still run, each with what is known of it.
struct RayStage {
  RayQueue<RTCRayHit16> rays;
  std::array<PathRay, kMostRays> state;
};

/// One thread's working memory, about 500 kB: kept between cells. Thread-bound.
struct PathBatch {
  int paths = 0;
  std::array<Path, kMostRays> path;
  std::array<RayStage, 2> stages;
  int stage = 0;  ///< Which of the two is in flight; the next rays gather in the other.
  RayQueue<RTCRay16> shadow_rays;
  std::array<ShadowedLight, kMostRays> shadowed;
  std::array<std::uint32_t, kMostRays> index_reversed;  ///< Of every ray's path.
  std::array<std::uint32_t, kMostRays> seed;
  SurfaceLots lots;
  EyeRays eye_rays;
  std::uint64_t rays_traced = 0;

  [[nodiscard]] RayStage& current() { return stages[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] RayStage& next() { return stages[static_cast<std::size_t>(1 - stage)]; }
};

}  // namespace cyclorama
