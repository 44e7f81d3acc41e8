// SPDX-License-Identifier: Apache-2.0
/// Codes for standard errors of samples, one byte each: the logarithm in steps of 12 %.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cyclorama::light {

/// Steps for a factor of 2, and the binary logarithm of the error of code 0. The largest code stands for 2^16.5.
inline constexpr float kErrorSteps = 6.0f;
inline constexpr float kErrorExponent = -26.0f;

/// Encodes an error in a store's unit, rounded up. Code 0 means that the error is none or less than 2^-26. Errors that
/// are unknown, NaN or too large get the largest code.
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
