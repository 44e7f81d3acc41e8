// SPDX-License-Identifier: Apache-2.0
/// Standard errors of samples in a byte: the logarithm, in steps of 12 %.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cyclorama::light {

/// Steps for a factor of 2, and the exponent of code 0; the largest code stands for 2^16.5.
inline constexpr float kErrorSteps = 6.0f;
inline constexpr float kErrorExponent = -26.0f;

/// Codes an error in a store's unit, rounded up. Code 0 means none, or less than 2^-26; errors that are not known, NaN or
/// too large take the largest code.
[[nodiscard]] inline std::uint8_t to_error_code(float error) {
  if (!(error < 65536.0f)) return 255;
  if (!(error > 0.0f)) return 0;
  const float steps = std::ceil(kErrorSteps * (std::log2(error) - kErrorExponent));
  return static_cast<std::uint8_t>(std::clamp(steps, 0.0f, 255.0f));
}

[[nodiscard]] inline float from_error_code(std::uint8_t code) {
  return code == 0 ? 0.0f : std::exp2(static_cast<float>(code) / kErrorSteps + kErrorExponent);
}

}  // namespace cyclorama::light
