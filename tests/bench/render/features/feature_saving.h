// SPDX-License-Identifier: Apache-2.0
/// Saving of a scene's specialised kernel: the same picture is rendered by the scene's own kernel and by those for
/// higher surface levels.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/render/renderer.h"
#include "renderfarm/render/surface_level.h"

namespace cyclorama {

/// Cost on one thread. Instructions are optional, since not every machine counts them.
struct KernelCost {
  double ns_per_ray = 0.0;  ///< Cpu time.
  std::optional<double> instructions_per_ray;
};

/// Saving against a kernel with more features: 1 - own cost / that kernel's.
struct FeatureSaving {
  render::SurfaceLevel kernel = render::SurfaceLevel::kMatte;
  KernelCost cost;
  double time_saving = 0.0;  ///< Median of the repetitions' ratios.
  std::optional<double> instruction_saving;
};

struct FeatureReport {
  render::SurfaceLevel kernel = render::SurfaceLevel::kMatte;  ///< The scene's own kernel.
  std::uint64_t rays = 0;                                      ///< In one picture.
  KernelCost cost;
  std::vector<FeatureSaving> savings;  ///< One for each level above `kernel`, in ascending order.
};

/// Runs the kernels in turn, `repetitions` times (at least once), in alternating order. Preconditions: check_view(),
/// and `renderer` was built with one thread, the caller's, on which instructions are counted. Errors: kUnavailable if
/// `cancelled` returned true.
Result<FeatureReport> measure_features(render::Renderer* renderer, const render::PanoramaView& view, int repetitions,
                                       const std::function<bool()>& cancelled);

}  // namespace cyclorama
