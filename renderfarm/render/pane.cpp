// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/pane.h"

#include "renderfarm/render/bsdf/layered.h"
#include "renderfarm/render/shading.h"

namespace cyclorama::render {
namespace {

constexpr int kMaxPanes = 16;  ///< Limit for one shadow ray; further panes count as opaque.

/// Returns the share of the light from behind the hit that arrives at the ray's start, against `direction`.
Vec3 let_through(const TriangleHit& hit, const SurfacePoint& point, const Vec3& direction) {
  const Vec3 wo = -direction;
  const Shading shading = shading_at<SurfaceLevel::kLayered>(hit, point, wo, Footprint{});
  return Scattering<SurfaceLevel::kLayered>(shading.bsdf, shading.normal, wo).straight();
}

}  // namespace

bool is_pane(const scene::Material& material, SurfaceLevel level) {
  if (level != SurfaceLevel::kLayered || !(material.transmission > 0.0f) || material.thickness > 0.0f) return false;
  return alpha_of(material.roughness) == 0.0f || material.metallic_roughness_texture.texture >= 0;
}

void cross_panes(const TraceScene& scene, PathBatch& batch) {
  if (batch.pane_rays == nullptr) batch.pane_rays = std::make_unique<RayQueue<RTCRayHit16>>();
  RayQueue<RTCRayHit16>& rays = *batch.pane_rays;
  std::array<std::uint16_t, kMaxRays> shadow_of;
  rays.clear();
  for (int i = 0; i < batch.shadow_rays.count(); ++i) {
    if (batch.shadow_rays.distance(i) < 0.0f) continue;
    shadow_of[static_cast<std::size_t>(rays.count())] = static_cast<std::uint16_t>(i);
    rays.add(batch.shadow_rays.origin(i), batch.shadow_rays.direction(i), batch.shadow_rays.distance(i),
             batch.shadow_rays.random_number(i));
  }
  for (int pane = 0; rays.count() > 0; ++pane) {
    const int count = rays.count();
    batch.rays_traced += static_cast<std::uint64_t>(count);
    // Remaining distance of each ray, because a hit overwrites the distance in the ray.
    std::array<float, kMaxRays> left;
    for (int i = 0; i < count; ++i) left[static_cast<std::size_t>(i)] = rays.distance(i);
    trace_nearest(scene.panes, Coherence::kIncoherent, rays);
    rays.clear();  // Rays that continue replace those that were already examined.
    for (int i = 0; i < count; ++i) {
      if (!rays.has_hit(i)) continue;
      const std::uint16_t shadow = shadow_of[static_cast<std::size_t>(i)];
      Vec3& light = batch.shadowed[shadow].light;
      const Vec3 direction = rays.direction(i);
      const TriangleHit hit = triangle_at(scene, rays.hit(i));
      const SurfacePoint point = surface_at(hit, direction);
      light = pane < kMaxPanes ? Vec3(light.cwiseProduct(let_through(hit, point, direction))) : Vec3(Vec3::Zero());
      if (light.isZero(0.0f)) continue;
      const float beyond = left[static_cast<std::size_t>(i)] - rays.distance(i);
      shadow_of[static_cast<std::size_t>(rays.count())] = shadow;
      rays.add(start_off_surface(point, -point.facing), direction, beyond,
               batch.shadow_rays.random_number(static_cast<int>(shadow)));
    }
  }
}

}  // namespace cyclorama::render
