// SPDX-License-Identifier: Apache-2.0
/// Settings to be measured for the trade of time and bytes against accuracy.
#pragma once

#include <string>
#include <vector>

#include "renderfarm/render/picture_quality.h"

namespace cyclorama {

/// Name of the setting that differs from the base; "together" if several do.
struct PlannedPoint {
  std::string knob;
  render::PictureQuality quality;
};

/// Returns the base setting, in the middle of every setting's range; each curve passes through it.
[[nodiscard]] render::PictureQuality trade_base();

/// Returns the settings to be measured, but not every combination: each setting is varied alone around the base, which
/// gives its curve; those that determine most of the time (samples, bounces, scale, and the denoiser) are varied
/// together, which gives the Pareto front. Every combination is valid and occurs once. `quick` omits most. Pictures
/// that differ only in their coding follow one another.
[[nodiscard]] std::vector<PlannedPoint> trade_plan(bool quick);

}  // namespace cyclorama
