// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/shade.h"

#include "renderfarm/render/shade_stages.h"

namespace cyclorama {

void draw_lots(PathBatch& batch) {
  const int count = batch.current().rays.count();
  // The rays of one batch have all met the same number of surfaces.
  const std::uint32_t first = kFirstSurface + kSurfaceDimensions * batch.current().state[0].surfaces;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const Path& path = batch.path[batch.current().state[i].path];
    batch.index_reversed[i] = path.index_reversed;
    batch.seed[i] = path.seed;
  }
  SurfaceLots& lots = batch.lots;
  const auto draw = [&](std::uint32_t dimension, SurfaceLots::Values& u, SurfaceLots::Values& v) {
    sample_pairs(count, batch.index_reversed.data(), batch.seed.data(), first + dimension, u.data(), v.data());
  };
  draw(kLight, lots.light, lots.through);
  draw(kLightPlace, lots.place_u, lots.place_v);
  draw(kScatter, lots.scatter_u, lots.scatter_v);
  draw(kLobe, lots.lobe, lots.spare);
}

void trace_shadows(const TraceScene& scene, PathBatch& batch) {
  RayQueue<RTCRay16>& rays = batch.shadow_rays;
  trace_any(scene.top, rays);
  batch.rays_traced += static_cast<std::uint64_t>(rays.count());
  for (int i = 0; i < rays.count(); ++i) {
    if (rays.distance(i) < 0.0f) continue;
    const ShadowedLight& shadowed = batch.shadowed[static_cast<std::size_t>(i)];
    Path& path = batch.path[shadowed.path];
    (shadowed.direct ? path.direct : path.indirect) += shadowed.light;
  }
  rays.clear();
}

ShadeStage shade_stage_for(const SceneNeeds& needs) {
  if (needs.surface == SurfaceLevel::kLayered) return layered_stage(needs);
  if (needs.normal_maps) return normal_mapped_stage(needs);
  if (needs.textures) return textured_stage(needs);
  return plain_stage(needs);
}

}  // namespace cyclorama
