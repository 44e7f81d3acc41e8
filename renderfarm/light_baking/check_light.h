// SPDX-License-Identifier: Apache-2.0
/// Compares pictures with stored light to path traced pictures, from eyes that were not used to compute the light.
#pragma once

#include <functional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/light/light_check.h"
#include "renderfarm/light_baking/stage_chain.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light_baking {

/// Size of the check. With the defaults, it costs about an eighth of the light of a scene and determines the errors of
/// blocks to 1e-5.
struct CheckSettings {
  int eyes = 32;
  int width = 80;
  int height = 32;
  int samples = 4;             ///< Samples of the pictures with stored light.
  int reference_samples = 32;  ///< Samples of each half of the reference.
};

inline constexpr int kCheckedBlockPx = 8;

/// Returns eyes that are random in the walkable area. They are not among the baker's eyes, unless the area is so narrow
/// that only the start is left.
[[nodiscard]] std::vector<Eigen::Vector3d> held_out_eyes(const scene::SceneInfo& info, int count);
/// Returns the view of held-out eye number `i`. It is 150 degrees wide; the headings of successive eyes cover the
/// circle.
[[nodiscard]] render::PanoramaView held_out_view(const scene::SceneInfo& info, const Eigen::Vector3d& eye, int i,
                                                 int width, int height);

struct CheckedLight {
  light::LightCheck check;
  double cpu_seconds = 0.0;
  double stored_cpu_s_per_mpx = 0.0;  ///< Cost of the pictures with stored light.
  double paths_cpu_s_per_mpx = 0.0;   ///< Cost of path tracing with the same number of samples.
};

/// Checks the renderer's present light. `progress` and `cancelled` may be null. Errors: kUnavailable if cancelled.
Result<CheckedLight> check_light(const render::Renderer& renderer, const CheckSettings& settings,
                                 const std::function<void(double)>& progress, const std::function<bool()>& cancelled);

/// The same as a stage of the light's computation, with a piece for each eye.
Result<CheckedLight> check_light(const render::Renderer& renderer, const CheckSettings& settings,
                                 const std::function<void(double)>& progress, const std::function<bool()>& cancelled,
                                 StageChain& stages);

}  // namespace cyclorama::light_baking
