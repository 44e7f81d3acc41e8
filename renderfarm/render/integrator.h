// SPDX-License-Identifier: Apache-2.0
/// Direct light: what a camera ray sees, lit by lamps, sky, ambient and the eye's lamp. Included by the kernel files
/// only.
///
/// An estimate of one sample each: one lamp, chosen by what it would give unshadowed, and one place on it; one
/// direction of the sky, chosen by the surface's reflection. Both are unbiased.
#pragma once

#include <limits>

#include "renderfarm/render/kernel.h"
#include "renderfarm/render/sampler.h"
#include "renderfarm/render/sky.h"
#include "renderfarm/render/surface.h"
#include "renderfarm/render/texture_lookup.h"

namespace cyclorama {

inline constexpr float kFar = std::numeric_limits<float>::infinity();

/// Dimensions of SampleSequence. Surfaces seen through others take kLayerDimensions more each.
enum Dimension : std::uint32_t { kPixelPlace, kLampPlace, kChoice, kSkyDirection, kLayer, kLayerDimensions };

/// Through this many half-transparent surfaces every ray goes on; then only those that still carry light, by lot.
inline constexpr int kCertainLayers = 8;
/// No real scene stacks more; a ray that is caught between two faces ends.
inline constexpr int kMostLayers = 256;

/// What a point of a surface gives back and gives off.
struct Shading {
  Bsdf bsdf;
  Vec3 normal = Vec3::UnitY();
  Vec3 emission = Vec3::Zero();
  float opacity = 1.0f;
};

template <SceneNeeds kNeeds>
Shading shading_at(const TriangleHit& hit, const SurfacePoint& point, const Vec3& wo) {
  const SurfaceMaterial& material = *hit.mesh->material;
  const Material& source = *material.source;
  const Eigen::Vector4f base = base_colour_at(hit, point.colour, kNeeds.textures);
  const Vec3 colour = base.head<3>().cwiseMax(0.0f);

  Shading shading;
  shading.normal = point.normal;
  shading.emission = source.emissive;
  if constexpr (kNeeds.blending) {
    if (material.blends) shading.opacity = std::clamp(base.w(), 0.0f, 1.0f);
  }
  if constexpr (kNeeds.normal_maps) shading.normal = mapped_normal(hit, point);
  if constexpr (kNeeds.textures) {
    if (material.emissive != nullptr) {
      const Vec2 uv = texcoord_at(hit, source.emissive_texture);
      shading.emission = shading.emission.cwiseProduct(lookup(*material.emissive, uv, Coding::kSrgb).head<3>());
    }
  }
  shading.bsdf = make_matte(colour);
  if constexpr (kNeeds.gloss) {
    if (material.glossy) {
      float metallic = source.metallic;
      float roughness = source.roughness;
      if constexpr (kNeeds.textures) {
        if (material.metallic_roughness != nullptr) {
          const Vec2 uv = texcoord_at(hit, source.metallic_roughness_texture);
          const Eigen::Vector4f texel = lookup(*material.metallic_roughness, uv, Coding::kLinear);
          roughness *= texel.y();
          metallic *= texel.z();
        }
      }
      shading.normal = reflecting_normal(shading.normal, point.facing, wo);
      shading.bsdf = make_glossy(colour, std::clamp(metallic, 0.0f, 1.0f), roughness);
    }
  }
  return shading;
}

/// One sample of one pixel.
template <SceneNeeds kNeeds>
class Integrator {
 public:
  Integrator(const TraceScene& scene, const Vec3& eye, const SampleSequence& sequence, std::uint64_t* rays)
      : scene_(scene), eye_(eye), sequence_(sequence), rays_(rays) {}

  /// Radiance that arrives at the eye from `direction`, a unit vector.
  [[nodiscard]] Vec3 radiance(const Vec3& direction) {
    Vec3 sum = Vec3::Zero();
    float through = 1.0f;
    Vec3 start = eye_;
    for (int layer = 0; layer < kMostLayers; ++layer) {
      RTCRayHit ray;
      ray.ray = make_ray(start.data(), direction.data(), kFar, alpha_seed());
      trace_nearest(scene_.top, &ray, Coherence::kCoherent);
      ++*rays_;
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        if constexpr (kNeeds.sky) sum += through * sky_radiance(scene_.sky, direction);
        return sum;
      }
      const TriangleHit hit = triangle_at(scene_, ray.hit);
      const SurfacePoint point = surface_at(hit, direction);
      const Shading shading = shading_at<kNeeds>(hit, point, -direction);
      first_dimension_ = static_cast<std::uint32_t>(layer) * kLayerDimensions;
      if (shading.opacity > 0.0f) sum += (through * shading.opacity) * reflected(point, shading, -direction);
      through *= 1.0f - shading.opacity;
      if (!kNeeds.blending || !goes_on(layer, &through)) return sum;
      start = start_off_surface(point, -point.facing);
    }
    return sum;
  }

 private:
  /// The lot that holes and glass in the way of a ray draw from: the same for every ray of the sample.
  [[nodiscard]] std::uint32_t alpha_seed() const { return sequence_.hash(0); }

  [[nodiscard]] bool goes_on(int layer, float* ret_through) const {
    if (!(*ret_through > 0.0f)) return false;
    if (layer < kCertainLayers) return true;
    const float chance = std::min(*ret_through, 0.95f);
    if (sequence_.pair(first_dimension_ + kLayer).x() >= chance) return false;
    *ret_through /= chance;
    return true;
  }

  [[nodiscard]] Vec3 reflected(const SurfacePoint& point, const Shading& shading, const Vec3& wo) {
    const Scattering<kNeeds.gloss> scattering(shading.bsdf, shading.normal, wo);
    Vec3 sum =
        shading.emission + scene_.ambient.cwiseProduct(scattering.albedo()) + from_eye_lamp(point, scattering, wo);
    const Vec2 choice = sequence_.pair(first_dimension_ + kChoice);
    if constexpr (kNeeds.lamps) sum += from_lamps(point, shading.normal, scattering, choice.x());
    if constexpr (kNeeds.sky) sum += from_sky(point, scattering, choice.y());
    return sum;
  }

  /// Its shadows lie behind what casts them, so no ray is needed.
  template <typename Scatter>
  [[nodiscard]] Vec3 from_eye_lamp(const SurfacePoint& point, const Scatter& scattering, const Vec3& wo) const {
    constexpr float kLeastDistance2 = 0.05f * 0.05f;  // The lamp is held beside the eye, not in it.
    if (scene_.eye_lamp.isZero(0.0f)) return Vec3::Zero();
    const float distance2 = std::max((point.position - eye_).squaredNorm(), kLeastDistance2);
    return scattering.evaluate(wo).cwiseProduct(scene_.eye_lamp) / distance2;
  }

  template <typename Scatter>
  [[nodiscard]] Vec3 from_lamps(const SurfacePoint& point, const Vec3& normal, const Scatter& scattering, float u) {
    float probability = 1.0f;
    const int chosen = choose_lamp(scene_.lamps, point.position, normal, u, &probability);
    if (chosen < 0) return Vec3::Zero();
    const LampAim at = aim(scene_.lamps[static_cast<std::size_t>(chosen)], point.position,
                           sequence_.pair(first_dimension_ + kLampPlace));
    if (!(point.facing.dot(at.direction) > 0.0f)) return Vec3::Zero();
    const Vec3 light = scattering.evaluate(at.direction).cwiseProduct(at.light) / probability;
    if (light.isZero(0.0f) || !reaches(point, at.direction, at.distance)) return Vec3::Zero();
    return light;
  }

  template <typename Scatter>
  [[nodiscard]] Vec3 from_sky(const SurfacePoint& point, const Scatter& scattering, float choice) {
    Vec3 weight;
    const Vec3 wi = scattering.sample(sequence_.pair(first_dimension_ + kSkyDirection), choice, &weight);
    if (!(point.facing.dot(wi) > 0.0f)) return Vec3::Zero();
    const Vec3 light = weight.cwiseProduct(sky_radiance(scene_.sky, wi));
    if (light.isZero(0.0f) || !reaches(point, wi, kFar)) return Vec3::Zero();
    return light;
  }

  [[nodiscard]] bool reaches(const SurfacePoint& point, const Vec3& direction, float distance) {
    const Vec3 start = start_off_surface(point, point.facing);
    RTCRay ray = make_ray(start.data(), direction.data(), distance, alpha_seed());
    ++*rays_;
    return !trace_any(scene_.top, &ray);
  }

  const TraceScene& scene_;
  Vec3 eye_;
  SampleSequence sequence_;
  std::uint64_t* rays_;
  std::uint32_t first_dimension_ = 0;
};

template <SceneNeeds kNeeds>
std::uint64_t trace_cell(const TraceScene& scene, const TraceView& view, const TraceCell& cell) {
  std::uint64_t rays = 0;
  for (int row = 0; row < cell.height; ++row) {
    float* out = cell.radiance + static_cast<std::size_t>(row) * cell.stride;
    for (int column = 0; column < cell.width; ++column, out += 3) {
      const int x = cell.x + column;
      const int y = cell.y + row;
      Vec3 sum = Vec3::Zero();
      for (int sample = 0; sample < view.samples; ++sample) {
        const SampleSequence sequence(view.seed, x, y, sample, view.samples);
        const Vec2 place = Vec2(static_cast<float>(x), static_cast<float>(y)) + sequence.pair(kPixelPlace);
        CameraRay ray;
        if (!view.camera.ray(place.x(), place.y(), &ray)) continue;
        const Vec3 eye = view.eye + ray.origin;
        const Vec3 radiance = Integrator<kNeeds>(scene, eye, sequence, &rays).radiance(ray.direction);
        if (is_finite(radiance)) sum += radiance;
      }
      Eigen::Map<Vec3>(out, 3) = sum / static_cast<float>(view.samples);
    }
  }
  return rays;
}

/// The kernel among the sixteen whose textures and normal maps are given.
template <bool kTextures, bool kNormalMaps>
[[nodiscard]] Kernel kernel_with(const SceneNeeds& needs) {
  constexpr auto kMake = []<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
    return std::array<Kernel, sizeof...(kIndex)>{&trace_cell<SceneNeeds{
        kTextures, kNormalMaps, (kIndex & 1) != 0, (kIndex & 2) != 0, (kIndex & 4) != 0, (kIndex & 8) != 0}>...};
  };
  constexpr std::array<Kernel, 16> kKernels = kMake(std::make_index_sequence<16>());
  return kKernels[static_cast<std::size_t>((needs.gloss ? 1 : 0) | (needs.blending ? 2 : 0) | (needs.lamps ? 4 : 0) |
                                           (needs.sky ? 8 : 0))];
}

// Defined in a file each, so that they compile side by side.
[[nodiscard]] Kernel plain_kernel(const SceneNeeds& needs);
[[nodiscard]] Kernel textured_kernel(const SceneNeeds& needs);
[[nodiscard]] Kernel normal_mapped_kernel(const SceneNeeds& needs);

}  // namespace cyclorama
