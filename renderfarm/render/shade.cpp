// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/shade.h"

#include "renderfarm/render/pane.h"

namespace cyclorama::render {

void draw_random_numbers(PathBatch& batch) {
  const int count = batch.current().rays.count();
  // The rays of one batch have all met the same number of surfaces.
  const std::uint32_t first = kFirstSurface + kSurfaceDimensions * batch.current().state[0].surfaces;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const Path& path = batch.path[batch.current().state[i].path];
    batch.index_reversed[i] = path.index_reversed;
    batch.seed[i] = path.seed;
  }
  SurfaceRandomNumbers& random_numbers = batch.random_numbers;
  const auto draw = [&](std::uint32_t dimension, SurfaceRandomNumbers::Values& u, SurfaceRandomNumbers::Values& v) {
    sample_pairs(count, batch.index_reversed.data(), batch.seed.data(), first + dimension, u.data(), v.data());
  };
  draw(kLight, random_numbers.light, random_numbers.through);
  draw(kLightPlace, random_numbers.place_u, random_numbers.place_v);
  draw(kScatter, random_numbers.scatter_u, random_numbers.scatter_v);
  draw(kLobe, random_numbers.lobe, random_numbers.spare);
}

void trace_shadows(const TraceScene& scene, PathBatch& batch) {
  RayQueue<RTCRay16>& rays = batch.shadow_rays;
  trace_any(scene.top, rays);
  batch.rays_traced += static_cast<std::uint64_t>(rays.count());
  if (scene.panes != nullptr) cross_panes(scene, batch);
  for (int i = 0; i < rays.count(); ++i) {
    if (rays.distance(i) < 0.0f) continue;
    const ShadowedLight& shadowed = batch.shadowed[static_cast<std::size_t>(i)];
    Path& path = batch.path[shadowed.path];
    (shadowed.direct ? path.direct : path.indirect) += shadowed.light;
  }
  rays.clear();
}

ShadeStage shade_stage_for(SurfaceLevel level) {
  switch (level) {
    case SurfaceLevel::kMatte:
      return &shade<SurfaceLevel::kMatte>;
    case SurfaceLevel::kGlossy:
      return &shade<SurfaceLevel::kGlossy>;
    case SurfaceLevel::kLayered:
      break;
  }
  return &shade<SurfaceLevel::kLayered>;
}

}  // namespace cyclorama::render
