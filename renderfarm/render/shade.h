// SPDX-License-Identifier: Apache-2.0
/// What happens where rays end: light that is found, light that is aimed at, and the next ray. Included by the kernel
/// files only, which instantiate shade() for combinations of needs.
///
/// An unbiased path tracer. At every surface one light is aimed at (more at the first one, if asked) and one direction
/// is chosen by the surface's own scattering; where both could have found the same light, they are weighed by the power
/// heuristic. Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, chapters 8 to 10.
#pragma once

#include <limits>

#include "renderfarm/render/kernel.h"
#include "renderfarm/render/sample_batch.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/shading.h"
#include "renderfarm/render/sky.h"

namespace cyclorama {

/// Dimensions of SampleSequence: the pixel's, then those of each surface.
inline constexpr std::uint32_t kPixelPlace = 0;
inline constexpr std::uint32_t kFirstSurface = 1;
enum SurfaceDimension : std::uint32_t { kLight, kLightPlace, kScatter, kLobe, kSurfaceDimensions };

/// Paths go on for certain after this many scatterings, then by lot, with the chance that they still matter.
inline constexpr int kCertainScatterings = 2;
/// Mirrors and clear surfaces that a path may meet beyond its bounces; then it ends.
inline constexpr int kMostPassages = 16;

/// The random numbers of one surface for every ray in flight.
void draw_lots(PathBatch& batch);
/// Traces what waits in batch.shadow_rays and gives the light that arrives to its path.
void trace_shadows(const TraceScene& scene, PathBatch& batch);

/// The stage for the rays of one batch.
template <SceneNeeds kNeeds>
class Shade {
 public:
  Shade(const TraceScene& scene, const TraceView& view, PathBatch& batch, CellFilm& film)
      : scene_(scene), view_(view), batch_(batch), film_(film), rays_(batch.current().rays) {}

  void run() {
    for (int i = 0; i < rays_.count(); ++i) {
      PathRay& ray = batch_.current().state[static_cast<std::size_t>(i)];
      if (rays_.has_hit(i)) {
        at_surface(i, ray);
      } else {
        at_nothing(i, ray);
      }
    }
    trace_shadows(scene_, batch_);
  }

 private:
  [[nodiscard]] Path& path_of(const PathRay& ray) { return batch_.path[ray.path]; }

  void found(const PathRay& ray, const Vec3& light) {
    Path& path = path_of(ray);
    (ray.scatterings < 2 ? path.direct : path.indirect) += light;
  }

  void at_nothing(int i, const PathRay& ray) {
    if constexpr (kNeeds.environment) {
      found(ray, ray.throughput.cwiseProduct(sky_radiance(scene_.sky, rays_.direction(i))));
    }
    if (view_.features && ray.surfaces == 0) film_.albedo[pixel_of(ray)] += Vec3::Ones();
  }

  [[nodiscard]] std::size_t pixel_of(const PathRay& ray) { return static_cast<std::size_t>(path_of(ray).pixel); }

  void at_surface(int i, PathRay& ray) {
    const Vec3 direction = rays_.direction(i);
    const Vec3 wo = -direction;
    const TriangleHit hit = triangle_at(scene_, rays_.hit(i));
    const SurfacePoint point = surface_at(hit, direction);
    const float cone_width = ray.cone_width + ray.cone_spread * rays_.distance(i);
    const Shading shading = shading_at<kNeeds>(hit, point, wo, cone_width);
    if (!shading.emission.isZero(0.0f)) found(ray, ray.throughput.cwiseProduct(shading.emission));
    if (ray.only_light) return;

    const Scattering<kNeeds.gloss ? SurfaceLevel::kGlossy : SurfaceLevel::kMatte> scattering(shading.bsdf,
                                                                                             shading.normal, wo);
    if (view_.features && ray.surfaces == 0) keep_features(i, ray, shading, scattering.albedo());
    shine_ambient(ray, scattering);
    if constexpr (kNeeds.lights) aim_at_lights(i, ray, point, shading.normal, scattering);
    shine_eye_lamp(i, ray, point, scattering, wo);
    go_on(i, ray, point, scattering, cone_width);
  }

  void keep_features(int i, const PathRay& ray, const Shading& shading, const Vec3& albedo) {
    const std::size_t pixel = pixel_of(ray);
    film_.albedo[pixel] += albedo;
    film_.normal[pixel] += shading.normal;
    film_.distance[pixel] += rays_.distance(i);
  }

  /// Light that was reflected once more than the ray was.
  void reflected(const PathRay& ray, const Vec3& light) {
    Path& path = path_of(ray);
    (ray.scatterings == 0 ? path.direct : path.indirect) += light;
  }

  template <typename Scatter>
  void shine_ambient(const PathRay& ray, const Scatter& scattering) {
    if (scene_.ambient.isZero(0.0f)) return;
    reflected(ray, ray.throughput.cwiseProduct(scene_.ambient).cwiseProduct(scattering.albedo()));
  }

  /// Seen from the eye its shadows lie behind what casts them, so no ray is needed there.
  template <typename Scatter>
  void shine_eye_lamp(int i, const PathRay& ray, const SurfacePoint& point, const Scatter& scattering, const Vec3& wo) {
    constexpr float kLeastDistance2 = 0.05f * 0.05f;  // The lamp is held beside the eye, not in it.
    if (scene_.eye_lamp.isZero(0.0f)) return;
    const Vec3 offset = view_.eye - point.position;
    const float distance2 = std::max(offset.squaredNorm(), kLeastDistance2);
    const Vec3 direction = ray.surfaces == 0 ? wo : normalized_or(offset, wo);
    const Vec3 light =
        ray.throughput.cwiseProduct(scattering.evaluate(direction)).cwiseProduct(scene_.eye_lamp) / distance2;
    if (ray.surfaces == 0) return reflected(ray, light);
    if (point.facing.dot(direction) > 0.0f) shadow(i, ray, point, direction, std::sqrt(distance2), light);
  }

  template <typename Scatter>
  void aim_at_lights(int i, const PathRay& ray, const SurfacePoint& point, const Vec3& normal,
                     const Scatter& scattering) {
    const auto slot = static_cast<std::size_t>(i);
    if (ray.surfaces > 0 || view_.quality.light_samples == 1) {
      return aim_at_light(i, ray, point, normal, scattering, batch_.lots.light[slot],
                          {batch_.lots.place_u[slot], batch_.lots.place_v[slot]}, 1.0f);
    }
    const auto parts = static_cast<std::uint32_t>(view_.quality.light_samples);
    const auto bits = static_cast<int>(std::bit_width(parts - 1));
    for (std::uint32_t part = 0; part < parts; ++part) {
      const std::uint32_t index = split_index_reversed(batch_.index_reversed[slot], bits, part);
      const SobolPoint light = sobol_point(index, batch_.seed[slot], kFirstSurface + kLight);
      const SobolPoint place = sobol_point(index, batch_.seed[slot], kFirstSurface + kLightPlace);
      aim_at_light(i, ray, point, normal, scattering, light.u, {place.u, place.v}, 1.0f / static_cast<float>(parts));
    }
  }

  template <typename Scatter>
  void aim_at_light(int i, const PathRay& ray, const SurfacePoint& point, const Vec3& normal, const Scatter& scattering,
                    float choice, const Vec2& place, float share) {
    float probability = 1.0f;
    const int chosen = choose_lamp(scene_.lamps, point.position, normal, choice, &probability);
    if (chosen < 0) return;
    const LampAim at = aim(scene_.lamps[static_cast<std::size_t>(chosen)], point.position, place);
    if (!(point.facing.dot(at.direction) > 0.0f)) return;
    const Vec3 light = scattering.evaluate(at.direction).cwiseProduct(at.light) * (share / probability);
    shadow(i, ray, point, at.direction, at.distance, ray.throughput.cwiseProduct(light));
  }

  void shadow(int i, const PathRay& ray, const SurfacePoint& point, const Vec3& direction, float distance,
              const Vec3& light) {
    if (light.isZero(0.0f)) return;
    if (batch_.shadow_rays.full()) trace_shadows(scene_, batch_);
    batch_.shadowed[static_cast<std::size_t>(batch_.shadow_rays.count())] = {light, ray.path, ray.scatterings == 0};
    const Vec3 side = point.facing.dot(direction) > 0.0f ? point.facing : Vec3(-point.facing);
    batch_.shadow_rays.add(start_off_surface(point, side), direction, distance,
                           batch_.index_reversed[static_cast<std::size_t>(i)]);
  }

  template <typename Scatter>
  void go_on(int i, const PathRay& ray, const SurfacePoint& point, const Scatter& scattering, float cone_width) {
    const auto slot = static_cast<std::size_t>(i);
    const bool last = ray.scatterings >= view_.quality.bounces;
    if (last && !kNeeds.environment) return;
    const ScatterSample scattered =
        scattering.sample({batch_.lots.scatter_u[slot], batch_.lots.scatter_v[slot]}, batch_.lots.lobe[slot]);
    if (scattered.weight.isZero(0.0f) || !(point.facing.dot(scattered.wi) > 0.0f)) return;

    PathRay next = ray;
    next.throughput = ray.throughput.cwiseProduct(scattered.weight);
    ++next.scatterings;
    ++next.surfaces;
    next.only_light = last;
    next.cone_width = cone_width;
    if (next.scatterings > kCertainScatterings) {
      const float chance = std::min(0.95f, next.throughput.maxCoeff());
      if (!(batch_.lots.through[slot] < chance)) return;
      next.throughput /= chance;
    }
    RayStage& stage = batch_.next();
    stage.state[static_cast<std::size_t>(stage.rays.count())] = next;
    stage.rays.add(start_off_surface(point, point.facing), scattered.wi, std::numeric_limits<float>::infinity(),
                   batch_.index_reversed[slot]);
  }

  const TraceScene& scene_;
  const TraceView& view_;
  PathBatch& batch_;
  CellFilm& film_;
  RayQueue<RTCRayHit16>& rays_;
};

template <SceneNeeds kNeeds>
void shade(const TraceScene& scene, const TraceView& view, PathBatch& batch, CellFilm& film) {
  Shade<kNeeds>(scene, view, batch, film).run();
}

}  // namespace cyclorama
