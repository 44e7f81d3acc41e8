// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/quality.h"

#include <fmt/format.h>

namespace cyclorama {
namespace {

Status in_range(const char* knob, double value, double least, double most) {
  if (value >= least && value <= most) return Done{};
  return Error(ErrorCode::kInvalidArgument, fmt::format("{} is {}; it must be {} to {}", knob, value, least, most));
}

}  // namespace

Status validate(const RenderQuality& quality) {
  constexpr double kMostLight = 1e9;
  TRY(in_range("samples", quality.samples, 1, kMostSamples));
  TRY(in_range("first_sample", quality.first_sample, 0, kMostSamples - quality.samples));
  TRY(in_range("sequence", quality.sequence, 0, kMostSamples));
  TRY(in_range("bounces", quality.bounces, 0, kMostBounces));
  TRY(in_range("light_samples", quality.light_samples, 1, kMostLightSamples));
  TRY(in_range("firefly_limit", static_cast<double>(quality.firefly_limit), 0, kMostLight));
  TRY(in_range("adaptive_error", static_cast<double>(quality.adaptive_error), 0, kMostLight));
  return in_range("adaptive_minimum", quality.adaptive_minimum, 2, kMostSamples);
}

}  // namespace cyclorama
