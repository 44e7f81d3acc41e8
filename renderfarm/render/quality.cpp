// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/quality.h"

#include <fmt/format.h>

namespace cyclorama {

Status check_knob(const char* knob, double value, double least, double most) {
  if (value >= least && value <= most) return Done{};
  return Error(ErrorCode::kInvalidArgument, fmt::format("{} is {}; it must be {} to {}", knob, value, least, most));
}

Status validate(const RenderQuality& quality) {
  TRY(check_knob("samples", quality.samples, 1, kMostSamples));
  TRY(check_knob("first_sample", quality.first_sample, 0, kMostSamples - quality.samples));
  TRY(check_knob("sequence", quality.sequence, 0, kMostSamples));
  TRY(check_knob("bounces", quality.bounces, 0, kMostBounces));
  TRY(check_knob("light_samples", quality.light_samples, 1, kMostLightSamples));
  TRY(check_knob("firefly_limit", static_cast<double>(quality.firefly_limit), 0, kMostLight));
  TRY(check_knob("adaptive_error", static_cast<double>(quality.adaptive_error), 0, kMostLight));
  return check_knob("adaptive_minimum", quality.adaptive_minimum, 2, kMostSamples);
}

}  // namespace cyclorama
