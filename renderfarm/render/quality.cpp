// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/quality.h"

#include <fmt/format.h>

namespace cyclorama::render {

Status check_knob(const char* knob, double value, double min, double max) {
  if (value >= min && value <= max) return Done{};
  return Error(ErrorCode::kInvalidArgument, fmt::format("{} is {}; it must be {} to {}", knob, value, min, max));
}

Status validate(const RenderQuality& quality) {
  TRY(check_knob("samples", quality.samples, 1, kMaxSamples));
  TRY(check_knob("first_sample", quality.first_sample, 0, kMaxSamples - quality.samples));
  TRY(check_knob("sequence", quality.sequence, 0, kMaxSamples));
  TRY(check_knob("bounces", quality.bounces, 0, kMaxBounces));
  TRY(check_knob("light_samples", quality.light_samples, 1, kMaxLightSamples));
  TRY(check_knob("firefly_limit", static_cast<double>(quality.firefly_limit), 0, kMaxRadianceLimit));
  TRY(check_knob("adaptive_error", static_cast<double>(quality.adaptive_error), 0, kMaxRadianceLimit));
  return check_knob("adaptive_minimum", quality.adaptive_minimum, 2, kMaxSamples);
}

}  // namespace cyclorama::render
