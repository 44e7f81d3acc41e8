// SPDX-License-Identifier: Apache-2.0
/// Conversion between light and code values. Source: IEC 61966-2-1 (sRGB).
#pragma once

#include <cmath>
#include <cstdint>

namespace cyclorama {

/// Converts a code value in [0, 1] to linear light in [0, 1].
[[nodiscard]] inline float srgb_to_linear(float code) {
  return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

/// Converts linear light to a code value in [0, 1]; light outside [0, 1] is clipped, and NaN gives 0.
[[nodiscard]] inline float linear_to_srgb(float linear) {
  if (!(linear > 0.0f)) return 0.0f;
  if (linear >= 1.0f) return 1.0f;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

/// Returns the 8-bit code value nearest to linear_to_srgb(). It uses a table, which is many times faster. Reentrant.
[[nodiscard]] std::uint8_t linear_to_srgb8(float linear);

}  // namespace cyclorama
