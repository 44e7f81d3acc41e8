// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/pacing_meter.h"

#include <cmath>
#include <utility>

namespace cyclorama::output {
namespace {
// Intervals between pictures, in refresh periods.
constexpr double kLate = 1.25;
constexpr double kMissed = 1.5;
}  // namespace

std::optional<PictureStep> PacingMeter::take(const HeadShown& shown) {
  if (shown.light != HeadShown::Light::kNew) {
    last_.reset();
    return std::nullopt;
  }
  const std::optional<TimePoint> before = std::exchange(last_, shown.at);
  if (!before || shown.at <= *before) return std::nullopt;
  PictureStep step;
  step.interval = shown.at - *before;
  const double refreshes = to_seconds(step.interval) * shown.refresh_hz;
  if (refreshes >= kMissed) step.missed = static_cast<std::uint64_t>(std::llround(refreshes)) - 1;
  step.is_late = refreshes > kLate && step.missed == 0;
  return step;
}

}  // namespace cyclorama::output
