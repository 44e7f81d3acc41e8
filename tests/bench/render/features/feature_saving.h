// SPDX-License-Identifier: Apache-2.0
/// What a scene saves because its kernel is compiled without what it does not need: the same picture is made by its own
/// kernel, by one that has one feature more, and by the one that has all.
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

/// Of one thread. Instructions where they can be counted.
struct KernelCost {
  double ns_per_ray = 0.0;  ///< Of its cpu time.
  std::optional<double> instructions_per_ray;
};

/// Against a kernel that has more. A saving is 1 - own cost / that kernel's.
struct FeatureSaving {
  SceneNeeds feature;  ///< What the kernel was asked to have besides the scene's own needs.
  SceneNeeds kernel;   ///< What it is compiled for; may be more.
  KernelCost cost;
  double time_saving = 0.0;  ///< The median of the repetitions' ratios.
  std::optional<double> instruction_saving;
};

struct FeatureReport {
  SceneNeeds kernel;       ///< The scene's own.
  std::uint64_t rays = 0;  ///< Of one picture.
  KernelCost cost;
  std::vector<FeatureSaving> savings;       ///< One for each need that `kernel` is without.
  std::optional<FeatureSaving> everything;  ///< None when `kernel` is the general one.
};

/// The kernels take turns, `repetitions` times (at least once), in alternating order. Precondition: check_view(), and
/// `renderer` was built with one thread, which is then the caller's: instructions are counted on it.
/// kUnavailable  `cancelled` returned true.
Result<FeatureReport> measure_features(Renderer* renderer, const PanoramaView& view, int repetitions,
                                       const std::function<bool()>& cancelled);

}  // namespace cyclorama
