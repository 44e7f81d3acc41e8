// SPDX-License-Identifier: Apache-2.0
/// Computes the light of a scene: the light that arrives at each point of its surfaces, directly and after bounces.
///
///     visible triangles ──► direct light at all base samples ──► bounces, each of which uses the previous one
///     ──► the last bounce, with many rays where visitors look ──► grids where vertices do not suffice
///     ──► a check from held-out eyes
///
/// Sources: Ward, Rubinstein and Clear, "A Ray Tracing Solution for Diffuse Interreflection", 1988, for computing light
/// by gathering; Christensen et al., "Global Illumination for Animated Films", 2012, for the use of stored light at the
/// second hit.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/light/light_store.h"
#include "renderfarm/light_baking/bake_settings.h"
#include "renderfarm/light_baking/light_pieces.h"
#include "renderfarm/render/renderer.h"

namespace cyclorama::light_baking {

/// A part of the work and its cost.
struct BakeStage {
  std::string name;
  double cpu_seconds = 0.0;
};

struct BakedLight {
  std::shared_ptr<const light::LightStore> store;
  double cpu_seconds = 0.0;          ///< Cost on this host in this run, without the check.
  double check_cpu_seconds = 0.0;    ///< Cost of the comparison with path tracing.
  std::uint64_t seen_triangles = 0;  ///< Number of seen triangles, each side counted separately.
  std::uint64_t grids = 0;
  std::uint64_t separate_samples = 0;  ///< Samples of grids that must not be used.
  std::uint64_t hidden_vertices = 0;   ///< Vertices behind or inside something, with light from beside them.
  double max_run_seconds = 0.0;        ///< Longest that a thread worked without looking whether it must end.
  std::vector<BakeStage> stages;       ///< In the order of the work; their sum is `cpu_seconds`.
};

/// Computes the light with `threads` threads (0: all). The result depends on the scene, the settings and the program
/// alone, not on threads. While it works, the renderer's light is replaced; afterwards the renderer has the result, or
/// none. `progress` may be null; `cancelled`, too. `pieces` decides which pieces are computed here, if not null;
/// however they are divided, the result has the same bits. Each named group of lamps has light of its own, which costs
/// as much again as all other light. The light of the eye lamp is not part of it. Errors:
/// kUnavailable if it was cancelled; those of `pieces`.
Result<BakedLight> bake_light(render::Renderer& renderer, const BakeSettings& settings, int threads,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled,
                              LightPieces* pieces = nullptr);

}  // namespace cyclorama::light_baking
