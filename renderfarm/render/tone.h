// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace cyclorama {

/// Exposed radiance to display light in [0, 1): untouched up to one half, so that what was measured or painted keeps
/// its value, then an exponential shoulder that meets it with the same slope and ends at 1. NaN and negative light give
/// 0.
[[nodiscard]] inline float tone_mapped(float exposed) {
  constexpr float kKnee = 0.5f;
  if (!(exposed > 0.0f)) return 0.0f;
  if (exposed <= kKnee) return exposed;
  return kKnee + (1.0f - kKnee) * (1.0f - std::exp((kKnee - exposed) / (1.0f - kKnee)));
}

}  // namespace cyclorama
