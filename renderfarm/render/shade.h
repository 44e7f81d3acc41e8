// SPDX-License-Identifier: Apache-2.0
/// Shading of ray hits: emitted light, light sampling and the next ray. Only shade.cpp instantiates shade(), once for
/// each surface level.
///
/// The path tracer is unbiased except for emission that light sampling skips (backs of triangles, dark texels) at the
/// last bounce. At every surface it samples one light (more at the first one, if requested) and one direction from the
/// BSDF; if both could have found the same light, the power heuristic weights them. Source: Veach, "Robust Monte Carlo
/// Methods for Light Transport Simulation", 1997, chapters 8 to 10.
#pragma once

#include <limits>
#include <optional>

#include "renderfarm/light/mean_direction.h"
#include "renderfarm/render/kernel.h"
#include "renderfarm/render/lights/eye_lamp.h"
#include "renderfarm/render/sample_batch.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/shading.h"

namespace cyclorama::render {

/// Dimensions of SampleSequence: those of the pixel, then those of each surface.
inline constexpr std::uint32_t kPixelPlace = 0;
inline constexpr std::uint32_t kFirstSurface = 1;
enum SurfaceDimension : std::uint32_t { kLight, kLightPlace, kScatter, kLobe, kSurfaceDimensions };

/// Russian roulette: the survival probability of a path is this factor times the largest component of its throughput,
/// at most 1. In a matte hall, with 16 samples and paths of up to three surfaces, error times cpu-seconds is minimal
/// for factors of 2 to 4, 16 % less than without roulette; for a factor of 1 it is greater than without roulette.
inline constexpr float kRouletteChance = 3.0f;
/// Number of mirrors and clear surfaces that a path may meet in addition to its bounces; then it ends.
inline constexpr int kMaxPassages = 16;

/// Draws the random numbers of one surface for every ray in flight.
void draw_random_numbers(PathBatch& batch);
/// Returns the seed for decisions at half-transparent surfaces along a ray that starts at the path's surface number
/// `surfaces`, counted from 1; 0 for a camera ray. A path that meets the same surface twice draws a new number each
/// time. The Owen scramble keeps the samples of a pixel evenly distributed.
[[nodiscard]] inline std::uint32_t alpha_random_number(std::uint32_t index_reversed, std::uint32_t seed,
                                                       std::uint32_t surfaces) {
  return scrambled_reversed(index_reversed, mix_bits(seed ^ mix_bits(surfaces + 1)));
}
/// Traces the queued batch.shadow_rays and adds the light that arrives to their paths.
void trace_shadows(const TraceScene& scene, PathBatch& batch);

/// Returns the power-heuristic weight of the sampling technique with the pdf `pdf` against the technique with the pdf
/// `other`, for the same light. A `pdf` of 0 means that there is only one technique.
[[nodiscard]] inline float share_of(float pdf, float other) {
  if (pdf == 0.0f) return 1.0f;
  const float ratio = other / pdf;
  return 1.0f / (1.0f + ratio * ratio);
}

/// Shades the rays of one batch. Thread-bound.
template <SurfaceLevel kLevel>
class Shade {
 public:
  Shade(const TraceScene& scene, const TraceView& view, PathBatch& batch, CellFilm& film)
      : scene_(scene), view_(view), batch_(batch), film_(film), rays_(batch.current().rays) {}

  void run() {
    const int count = rays_.count();
    for (int i = 0; i < count; ++i) {
      // Memory access is the bottleneck, so the data of later rays is prefetched.
      if (i + kAhead < count) prefetch(i + kAhead);
      if (i + kAhead / 2 < count) prefetch_vertices(i + kAhead / 2);
      PathRay& ray = batch_.current().state[static_cast<std::size_t>(i)];
      if (rays_.has_hit(i)) {
        at_hit(i, ray);
      } else {
        at_nothing(i, ray);
      }
    }
    trace_shadows(scene_, batch_);
  }

 private:
  static constexpr int kAhead = 16;
  using Scatter = Scattering<kLevel>;

  /// Returns the mesh that the ray hit; null if it hit nothing or a lamp.
  [[nodiscard]] const SurfaceMesh* mesh_at(int i, const RTCHit& hit) const {
    if (!rays_.has_hit(i) || is_lamp(hit)) return nullptr;
    return scene_.placements[top_of(hit)].mesh;
  }
  // Inlining is forced because gcc would treat a function that only prefetches as free of effects and drop the calls.
  [[gnu::always_inline]] void prefetch(int i) const {
    const RTCHit hit = rays_.hit(i);
    const SurfaceMesh* const mesh = mesh_at(i, hit);
    if (mesh == nullptr) return;
    mesh->prefetch(hit.primID);
  }
  [[gnu::always_inline]] void prefetch_vertices(int i) const {
    const RTCHit hit = rays_.hit(i);
    const SurfaceMesh* const mesh = mesh_at(i, hit);
    if (mesh == nullptr) return;
    mesh->prefetch_vertices(hit.primID);
  }

  [[nodiscard]] bool is_lamp(const RTCHit& hit) const {
    return hit.instID[0] == RTC_INVALID_GEOMETRY_ID && scene_.lamps.holds(hit.geomID);
  }

  [[nodiscard]] Path& path_of(const PathRay& ray) { return batch_.path[ray.path]; }
  [[nodiscard]] std::size_t pixel_of(const PathRay& ray) { return static_cast<std::size_t>(path_of(ray).pixel); }

  /// Adds to a path the light that its ray hit.
  void found(const PathRay& ray, const Vec3& light) {
    Path& path = path_of(ray);
    (ray.scatterings < 2 ? path.direct : path.indirect) += ray.throughput.cwiseProduct(light);
  }

  void at_nothing(int i, const PathRay& ray) {
    const Vec3 direction = rays_.direction(i);
    const Vec3 light = scene_.lights.environment(direction);
    if (!light.isZero(0.0f)) {
      const float aimed =
          ray.pdf > 0.0f ? scene_.lights.environment_pdf(aim_start(i, ray), ray.from_normal, direction) : 0.0f;
      // A body that has no surface in this direction counts as infinitely thick: every channel that it absorbs is
      // black.
      const Vec3 left = (ray.absorption.array() > 0.0f).select(Vec3::Zero(), light);
      found(ray, left * (view_.lamps[0] * share_of(ray.pdf, aims_from_start_of(ray) * aimed)));
    }
    if (view_.features && ray.surfaces == 0) film_.albedo[pixel_of(ray)] += Vec3::Ones();
  }

  void at_hit(int i, PathRay& ray) {
    const RTCHit hit = rays_.hit(i);
    if constexpr (kLevel == SurfaceLevel::kLayered) {
      if (!ray.absorption.isZero(0.0f)) {
        ray.throughput = ray.throughput.cwiseProduct((-rays_.distance(i) * ray.absorption).array().exp().matrix());
      }
    }
    if (is_lamp(hit)) return at_lamp(i, ray, scene_.lamps.light_of(hit.geomID, hit.primID));
    at_surface(i, ray, hit);
  }

  /// Returns the point where the ray's direction was chosen, at which light was sampled as well.
  [[nodiscard]] Vec3 aim_start(int i, const PathRay& ray) const {
    if constexpr (kLevel != SurfaceLevel::kLayered) return rays_.origin(i);
    return rays_.origin(i) - ray.passed_m * rays_.direction(i);
  }
  /// Returns the number of light samples taken at the point where the ray's direction was chosen.
  [[nodiscard]] float aims_from_start_of(const PathRay& ray) const {
    return ray.aimed_surfaces == 1 ? static_cast<float>(view_.quality.light_samples) : 1.0f;
  }

  /// Returns the weight of a light that the ray hit, considering that light sampling might have found it as well.
  [[nodiscard]] float share_of_met(int i, const PathRay& ray, LightIndex light) const {
    if (ray.pdf == 0.0f || light == kNoLight) return 1.0f;
    const float aimed = scene_.lights.pdf(aim_start(i, ray), ray.from_normal, light, rays_.direction(i),
                                          ray.passed_m + rays_.distance(i));
    return share_of(ray.pdf, aims_from_start_of(ray) * aimed);
  }

  void at_lamp(int i, const PathRay& ray, LightIndex light) {
    const Vec3 radiance = scene_.lights.radiance(light, rays_.origin(i), rays_.direction(i));
    const float level = view_.lamps[scene_.lights.group_of(light)];
    if (!radiance.isZero(0.0f)) found(ray, radiance * (level * share_of_met(i, ray, light)));
    if (!view_.features || ray.surfaces > 0) return;
    film_.albedo[pixel_of(ray)] += Vec3::Ones();
    film_.normal[pixel_of(ray)] -= rays_.direction(i);
    film_.distance[pixel_of(ray)] += rays_.distance(i);
  }

  void at_surface(int i, PathRay& ray, const RTCHit& hit) {
    const Vec3 direction = rays_.direction(i);
    const Vec3 wo = -direction;
    const TriangleHit triangle = triangle_at(scene_, hit);
    const SurfacePoint point = surface_at(triangle, direction);
    const Footprint footprint{ray.cone_width + ray.cone_spread * rays_.distance(i), std::abs(point.facing.dot(wo))};
    const Shading shading = shading_at<kLevel>(triangle, point, wo, footprint);
    if (!shading.emission.isZero(0.0f)) {
      const LightIndex light = scene_.lights.of_triangle(top_of(hit), hit.primID);
      found(ray, shading.emission * (view_.lamps[0] * share_of_met(i, ray, light)));
    }
    if (ray.only_light) return cross_pane(i, ray, point, shading, wo);

    const Scatter scattering(shading.bsdf, shading.normal, wo);
    if (view_.features && ray.surfaces == 0) keep_features(i, ray, shading, scattering.albedo());
    shine_eye_lamp(i, ray, point, scattering, wo);
    const std::optional<Vec3> stored = stored_light(ray, hit, triangle, point, shading.normal);
    if (ray.surfaces == 0 && !stored) film_.lacks_light[pixel_of(ray)] = true;
    if (stored) {
      return shine_stored_light(i, ray, point, shading, wo, footprint.width, *stored);
    }
    shine_ambient(ray, scattering);
    // Light from behind counts if the surface transmits it.
    const Vec3 side = shading.one_sided ? shading.normal : Vec3(Vec3::Zero());
    const bool last = ray.scatterings >= view_.quality.bounces;
    const bool continues = (!last || shading.sharp) && ray.surfaces < view_.quality.bounces + kMaxPassages;
    aim_at_lights(i, ray, point, shading.normal, side, scattering, continues);
    if (continues) continue_path(i, ray, point, shading, side, scattering, footprint.width, last);
  }

  /// Continues a ray through a pane if the ray collects only light (PathRay::only_light).
  void cross_pane(int i, const PathRay& ray, const SurfacePoint& point, const Shading& shading, const Vec3& wo) {
    if constexpr (kLevel == SurfaceLevel::kLayered) {
      if (!shading.bsdf.thin || ray.surfaces >= view_.quality.bounces + kMaxPassages) return;
      PathRay next = ray;
      next.throughput = ray.throughput.cwiseProduct(Scatter(shading.bsdf, shading.normal, wo).straight());
      if (next.throughput.isZero(0.0f)) return;
      next.passed_m += rays_.distance(i);
      ++next.surfaces;
      go_on(i, next, start_off_surface(point, -point.facing), rays_.direction(i));
    }
  }

  void keep_features(int i, const PathRay& ray, const Shading& shading, const Vec3& albedo) {
    const std::size_t pixel = pixel_of(ray);
    film_.albedo[pixel] += albedo;
    film_.normal[pixel] += shading.normal;
    film_.distance[pixel] += rays_.distance(i);
  }

  /// Adds light that was scattered once more than the ray itself; `light` includes the throughput.
  void reflected(const PathRay& ray, const Vec3& light) {
    Path& path = path_of(ray);
    (ray.scatterings == 0 ? path.direct : path.indirect) += light;
  }

  /// Returns the light that was computed ahead for this point; null if paths must be traced.
  [[nodiscard]] std::optional<Vec3> stored_light(const PathRay& ray, const RTCHit& hit, const TriangleHit& triangle,
                                                 const SurfacePoint& point, const Vec3& normal) const {
    if (view_.light == nullptr || !view_.quality.stored_light) return std::nullopt;
    if (ray.scatterings > view_.max_stored_scatterings) return std::nullopt;
    const SurfaceMesh& mesh = *triangle.mesh;
    if (!reads_stored_light(*mesh.material)) return std::nullopt;
    const light::LightPlace place{top_of(hit), point.front ? 0 : 1, hit.primID, mesh.triangles[hit.primID],
                                  triangle.weights};
    if (mesh.material->normal == nullptr) return view_.light->lit(place, view_.lamps);
    return view_.light->lit(place, view_.lamps, [&](const light::LightStore& group) {
      return light::bent_share(group.direction_at(place), point.normal, normal);
    });
  }

  /// Adds the stored light that wide lobes reflect. The path ends here unless there is also a narrower lobe, which is
  /// traced.
  void shine_stored_light(int i, const PathRay& ray, const SurfacePoint& point, const Shading& shading, const Vec3& wo,
                          float cone_width, const Vec3& stored) {
    const Vec3 light = ray.throughput.cwiseProduct(stored);
    if constexpr (kLevel != SurfaceLevel::kMatte) {
      if (shading.bsdf.f90 > 0.0f || shading.bsdf.metallic > 0.0f) {
        const Scattering<SurfaceLevel::kGlossy> glossy(shading.bsdf, shading.normal, wo);
        if (shading.bsdf.alpha >= kWideAlpha) return reflected(ray, light.cwiseProduct(glossy.albedo()));
        reflected(ray, light.cwiseProduct(glossy.wide_albedo()));
        return trace_lobe(i, ray, point, shading, GlossyLobe(glossy), cone_width);
      }
    }
    reflected(ray, light.cwiseProduct(shading.bsdf.base_colour));
  }

  /// Samples the lights and continues the path, both with one lobe.
  template <typename Lobe>
  void trace_lobe(int i, const PathRay& ray, const SurfacePoint& point, const Shading& shading, const Lobe& lobe,
                  float cone_width) {
    const Vec3& side = shading.normal;
    const bool last = ray.scatterings >= view_.quality.bounces;
    const bool continues = ray.surfaces < view_.quality.bounces + kMaxPassages;
    aim_at_lights(i, ray, point, shading.normal, side, lobe, continues);
    if (continues) continue_path(i, ray, point, shading, side, lobe, cone_width, last);
  }

  void shine_ambient(const PathRay& ray, const Scatter& scattering) {
    if (scene_.ambient.isZero(0.0f)) return;
    reflected(ray, view_.lamps[0] * ray.throughput.cwiseProduct(scene_.ambient).cwiseProduct(scattering.albedo()));
  }

  /// Adds the light of the lamp at the eye. Surfaces that camera rays hit need no shadow ray.
  void shine_eye_lamp(int i, const PathRay& ray, const SurfacePoint& point, const Scatter& scattering, const Vec3& wo) {
    if (ray.scatterings > 0 || scene_.eye_lamp.isZero(0.0f)) return;
    const EyeLampLight lamp = eye_lamp_at(scene_.eye_lamp, view_.eye, point.position, wo);
    const Vec3 direction = ray.surfaces == 0 ? wo : lamp.direction;
    const Vec3 light = ray.throughput.cwiseProduct(scattering.evaluate(direction)).cwiseProduct(lamp.irradiance);
    if (ray.surfaces == 0) return reflected(ray, light);
    if (point.facing.dot(direction) > 0.0f)
      shadow(alpha_random_number_of(i, ray), ray, point, direction, lamp.distance, light);
  }

  template <typename Lobes>
  void aim_at_lights(int i, const PathRay& ray, const SurfacePoint& point, const Vec3& normal, const Vec3& side,
                     const Lobes& scattering, bool continues) {
    if (scene_.lights.empty()) return;
    const auto slot = static_cast<std::size_t>(i);
    if (ray.surfaces > 0 || view_.quality.light_samples == 1) {
      return aim_at_light({batch_.random_numbers.light[slot],
                           {batch_.random_numbers.place_u[slot], batch_.random_numbers.place_v[slot]},
                           1.0f,
                           alpha_random_number_of(i, ray)},
                          ray, point, normal, side, scattering, continues);
    }
    const auto parts = static_cast<std::uint32_t>(view_.quality.light_samples);
    int bits = 0;
    while ((1u << bits) < parts) ++bits;
    for (std::uint32_t part = 0; part < parts; ++part) {
      const std::uint32_t index = split_index_reversed(batch_.index_reversed[slot], bits, part);
      // The bits shifted out of the index select another sequence.
      const std::uint32_t seed = batch_.seed[slot] ^ mix_bits(batch_.index_reversed[slot] & ((1u << bits) - 1u));
      const SobolPoint light = sobol_point(index, seed, kFirstSurface + kLight);
      const SobolPoint place = sobol_point(index, seed, kFirstSurface + kLightPlace);
      aim_at_light(
          {light.u, {place.u, place.v}, static_cast<float>(parts), alpha_random_number(index, seed, ray.surfaces + 1u)},
          ray, point, normal, side, scattering, continues);
    }
  }

  /// The random numbers of one of `parts` light samples.
  struct AimRandomNumbers {
    float choice = 0.0f;
    Vec2 place = Vec2::Zero();
    float parts = 1.0f;
    std::uint32_t veil = 0;
  };

  template <typename Lobes>
  void aim_at_light(const AimRandomNumbers& random_numbers, const PathRay& ray, const SurfacePoint& point,
                    const Vec3& normal, const Vec3& side, const Lobes& scattering, bool continues) {
    LightSample aim;
    const Vec3 start = start_off_surface(point, point.facing);
    if (!scene_.lights.sample(start, side, random_numbers.choice, random_numbers.place, &aim)) return;
    // The same test as in continue_path(): light must not leak through the triangle where its normal and the shading
    // normal disagree.
    if ((point.facing.dot(aim.direction) > 0.0f) != (normal.dot(aim.direction) > 0.0f)) return;
    Vec3 light = scattering.evaluate(aim.direction).cwiseProduct(aim.radiance_over_pdf) * view_.lamps[aim.group];
    if (light.isZero(0.0f)) return;
    if (continues && aim.pdf > 0.0f) light *= share_of(random_numbers.parts * aim.pdf, scattering.pdf(aim.direction));
    shadow(random_numbers.veil, ray, point, aim.direction, aim.distance,
           ray.throughput.cwiseProduct(light) / random_numbers.parts);
  }

  void shadow(std::uint32_t veil, const PathRay& ray, const SurfacePoint& point, const Vec3& direction, float distance,
              const Vec3& light) {
    if (light.isZero(0.0f)) return;
    if (batch_.shadow_rays.full()) trace_shadows(scene_, batch_);
    batch_.shadowed[static_cast<std::size_t>(batch_.shadow_rays.count())] = {light, ray.path, ray.scatterings == 0};
    const Vec3 side = point.facing.dot(direction) > 0.0f ? point.facing : Vec3(-point.facing);
    batch_.shadow_rays.add(start_off_surface(point, side), direction, distance, veil);
  }

  template <typename Lobes>
  void continue_path(int i, const PathRay& ray, const SurfacePoint& point, const Shading& shading, const Vec3& side,
                     const Lobes& scattering, float cone_width, bool last) {
    const auto slot = static_cast<std::size_t>(i);
    const ScatterSample sample =
        scattering.sample({batch_.random_numbers.scatter_u[slot], batch_.random_numbers.scatter_v[slot]},
                          batch_.random_numbers.lobe[slot]);
    if (sample.weight.isZero(0.0f)) return;
    // Light must not leak through the triangle where its normal and the shading normal disagree.
    if ((point.facing.dot(sample.wi) > 0.0f) == sample.through) return;

    PathRay next = ray;
    next.throughput = ray.throughput.cwiseProduct(sample.weight);
    next.cone_width = cone_width;
    ++next.surfaces;
    const bool mirror = sample.pdf == 0.0f;
    if (mirror && sample.through && shading.bsdf.thin) {  // A pane.
      next.passed_m += rays_.distance(i);
    } else {
      next.pdf = sample.pdf;
      next.from_normal = side;
      next.aimed_surfaces = next.surfaces;
      next.passed_m = 0.0f;
    }
    if (!mirror && !sample.through) {
      ++next.scatterings;
      next.only_light = last;
    }
    if constexpr (kLevel == SurfaceLevel::kLayered) {
      if (sample.through && !shading.bsdf.thin) {
        next.absorption = shading.bsdf.inside ? Vec3(Vec3::Zero()) : shading.absorption;
      }
    }
    const float chance = kRouletteChance * next.throughput.maxCoeff();
    if (chance < 1.0f) {
      if (!(batch_.random_numbers.through[slot] < chance)) return;
      next.throughput /= chance;
    }
    go_on(i, next, start_off_surface(point, sample.through ? Vec3(-point.facing) : point.facing), sample.wi);
  }

  /// Adds the next ray of a path.
  void go_on(int i, const PathRay& next, const Vec3& start, const Vec3& direction) {
    RayStage& stage = batch_.next();
    stage.state[static_cast<std::size_t>(stage.rays.count())] = next;
    const auto slot = static_cast<std::size_t>(i);
    stage.rays.add(start, direction, std::numeric_limits<float>::infinity(),
                   alpha_random_number(batch_.index_reversed[slot], batch_.seed[slot], next.surfaces));
  }

  /// Returns the alpha_random_number() of rays that start at the hit.
  [[nodiscard]] std::uint32_t alpha_random_number_of(int i, const PathRay& ray) const {
    const auto slot = static_cast<std::size_t>(i);
    return alpha_random_number(batch_.index_reversed[slot], batch_.seed[slot], ray.surfaces + 1u);
  }

  const TraceScene& scene_;
  const TraceView& view_;
  PathBatch& batch_;
  CellFilm& film_;
  RayQueue<RTCRayHit16>& rays_;
};

template <SurfaceLevel kLevel>
void shade(const TraceScene& scene, const TraceView& view, PathBatch& batch, CellFilm& film) {
  Shade<kLevel>(scene, view, batch, film).run();
}

}  // namespace cyclorama::render
