// SPDX-License-Identifier: Apache-2.0
/// Saving of a scene's specialised kernel: the same picture is rendered by the scene's own kernel, by one with one more
/// feature, and by the general one.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/requirements.h"
#include "renderfarm/tools/scene_need.h"

namespace cyclorama {

/// Cost on one thread. Instructions are optional, since not every machine counts them.
struct KernelCost {
  double ns_per_ray = 0.0;  ///< Cpu time.
  std::optional<double> instructions_per_ray;
};

/// Saving against a kernel with more features: 1 - own cost / that kernel's.
struct FeatureSaving {
  render::SceneNeeds feature;  ///< Requested in addition to the scene's own needs.
  render::SceneNeeds kernel;   ///< Features of the compiled kernel; may be more.
  KernelCost cost;
  double time_saving = 0.0;  ///< Median of the repetitions' ratios.
  std::optional<double> instruction_saving;
};

struct FeatureReport {
  render::SceneNeeds kernel;  ///< The scene's own kernel.
  std::uint64_t rays = 0;     ///< In one picture.
  KernelCost cost;
  std::vector<FeatureSaving> savings;       ///< One for each feature that `kernel` lacks.
  std::optional<FeatureSaving> everything;  ///< Empty if `kernel` is the general one.
};

/// Runs the kernels in turn, `repetitions` times (at least once), in alternating order. Preconditions: check_view(),
/// and `renderer` was built with one thread, the caller's, on which instructions are counted. Errors: kUnavailable if
/// `cancelled` returned true.
Result<FeatureReport> measure_features(render::Renderer* renderer, const render::PanoramaView& view, int repetitions,
                                       const std::function<bool()>& cancelled);

}  // namespace cyclorama
