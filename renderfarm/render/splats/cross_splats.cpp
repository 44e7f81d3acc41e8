// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/splats/cross_splats.h"

#include <algorithm>

#include "common/image/colour.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/splats/splat_scene.h"

namespace cyclorama::render {
namespace {

Vec3 linear_of(const Vec3& code) {
  return {srgb_to_linear(code.x()), srgb_to_linear(code.y()), srgb_to_linear(code.z())};
}

struct Crossing {
  Vec3 radiance = Vec3::Zero();
  float transmittance = 1.0f;
  float depth_m = 0.0f;
};
using Crossings = std::array<Crossing, kMaxRays>;

/// Multiplies each crossing's radiance by the share of the scene's light that meshes do not block there, estimated with
/// one light.
void shadow(const TraceScene& scene, const TraceView& view, PathBatch& batch, Crossings& crossings) {
  const RayStage& stage = batch.current();
  const float ambient = kPi * luminance(scene.ambient);
  std::array<std::uint16_t, kMaxRays> ray_of;
  std::array<float, kMaxRays> direct_of;
  RayQueue<RTCRay16>& rays = batch.shadow_rays;
  for (int i = 0; i < stage.rays.count(); ++i) {
    const auto slot = static_cast<std::size_t>(i);
    const Crossing& crossing = crossings[slot];
    if (crossing.radiance.isZero(0.0f) || !std::isfinite(crossing.depth_m)) continue;
    const PathRay& ray = stage.state[slot];
    const Path& path = batch.path[ray.path];
    constexpr std::uint32_t kSplatSeed = 0x5b1a7u;  // Gives other random numbers than those of surfaces.
    const std::uint32_t seed = path.seed ^ mix_bits(kSplatSeed + ray.surfaces);
    const SobolPoint choice = sobol_point(path.index_reversed, seed, 0);
    const SobolPoint place = sobol_point(path.index_reversed, seed, 1);
    const Vec3 point = stage.rays.origin(i) + crossing.depth_m * stage.rays.direction(i);
    LightSample aim;
    if (!scene.lights.sample(point, Vec3::Zero(), choice.u, {place.u, place.v}, &aim)) continue;
    const auto shadow = static_cast<std::size_t>(rays.count());
    ray_of[shadow] = static_cast<std::uint16_t>(i);
    direct_of[shadow] = luminance(aim.radiance_over_pdf) * view.lamps[aim.group];
    rays.add(point, aim.direction, aim.distance, mix_bits(seed));
  }
  trace_any(scene.top, rays);
  batch.rays_traced += static_cast<std::uint64_t>(rays.count());
  for (int i = 0; i < rays.count(); ++i) {
    const auto shadow = static_cast<std::size_t>(i);
    if (rays.distance(i) >= 0.0f || !(direct_of[shadow] > 0.0f)) continue;
    crossings[ray_of[shadow]].radiance *= ambient / (ambient + direct_of[shadow]);
  }
  rays.clear();
}

void note_splat_depth(const PathBatch& batch, std::size_t path, float depth_m, CellFilm& film) {
  const auto pixel = static_cast<std::size_t>(batch.path[path].pixel);
  const std::size_t row = pixel / (kCellPx * kDepthCellPx);
  float& nearest_m = film.nearest_m[row * kDepthsPerSide + pixel % kCellPx / kDepthCellPx];
  nearest_m = std::min(nearest_m, depth_m);
}

}  // namespace

Vec3 radiance_of_splats(const Vec3& colour, float transmittance, bool is_linear, bool is_alone) {
  if (is_linear) return colour;
  const float covered = 1.0f - transmittance;
  if (is_alone || !(covered > 0.0f)) return linear_of(colour);
  return covered * linear_of(colour / covered);
}

void cross_splats(const TraceScene& scene, const TraceView& view, bool is_camera, PathBatch& batch, CellFilm& film) {
  RayStage& stage = batch.current();
  const auto crossings = std::make_unique<Crossings>();
  const bool has_background = scene.lights.has_environment();
  for (int i = 0; i < stage.rays.count(); ++i) {
    const bool has_hit = stage.rays.has_hit(i);
    const SplatLight light = scene.splats->trace(stage.rays.origin(i), stage.rays.direction(i), stage.rays.distance(i));
    if (light.transmittance == 1.0f) continue;
    (*crossings)[static_cast<std::size_t>(i)] = {
        radiance_of_splats(light.colour, light.transmittance, scene.splats->is_linear(), !has_hit && !has_background),
        light.transmittance, light.depth_m};
    if (is_camera && view.depth)
      note_splat_depth(batch, stage.state[static_cast<std::size_t>(i)].path, light.depth_m, film);
  }
  if (!scene.placements.empty() && !scene.lights.empty()) shadow(scene, view, batch, *crossings);
  for (int i = 0; i < stage.rays.count(); ++i) {
    const Crossing& crossing = (*crossings)[static_cast<std::size_t>(i)];
    PathRay& ray = stage.state[static_cast<std::size_t>(i)];
    Path& path = batch.path[ray.path];
    (ray.scatterings < 2 ? path.direct : path.indirect) +=
        view.lamps[0] * ray.throughput.cwiseProduct(crossing.radiance);
    ray.throughput *= crossing.transmittance;
  }
  batch.rays_traced += static_cast<std::uint64_t>(stage.rays.count());
}

}  // namespace cyclorama::render
