// SPDX-License-Identifier: Apache-2.0
/// Computes the light of a scene: what arrives at each point of its surfaces, directly and after the scene's bounces.
///
///     visible triangles ──► direct light at all base samples ──► one bounce after the other, each of which reads the
///     one before ──► the last bounce, finely where visitors look ──► grids where the vertices are not enough
///
/// Sources: Ward, Rubinstein and Clear, "A Ray Tracing Solution for Diffuse Interreflection", 1988, for light computed
/// by gathering; Christensen et al., "Global Illumination for Animated Films", 2012, for reading stored light at the
/// second hit.
#pragma once

#include <functional>
#include <memory>

#include "common/base/result.h"
#include "renderfarm/light/light_store.h"
#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::light_baking {

struct BakedLight {
  std::shared_ptr<const light::LightStore> store;
  double cpu_seconds = 0.0;
  std::uint64_t seen_triangles = 0;  ///< Both sides of a triangle count separately.
  std::uint64_t grids = 0;
  std::uint64_t separate_samples = 0;  ///< Number of grid samples that must not be used.
};

/// Computes the light with `threads` threads (0: all). The result depends on the scene, the settings and the program
/// alone, not on threads. While it works, the renderer's light is replaced; afterwards the renderer has the result, or
/// none. `progress` may be null; `cancelled`, too. Errors: kInvalidArgument for a scene whose light moves with the
/// visitor (an eye lamp); kUnavailable if it was cancelled.
Result<BakedLight> bake_light(render::Renderer& renderer, const BakeSettings& settings, int threads,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled);

}  // namespace cyclorama::light_baking
