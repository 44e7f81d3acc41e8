// SPDX-License-Identifier: Apache-2.0
/// Colours in 32 bits: three mantissas of 9 bits with a common exponent of 5 bits. Source: OpenGL's RGB9_E5,
/// EXT_texture_shared_exponent. The error of a channel is at most 1/512 of the largest channel.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace cyclorama::light {

/// Largest value that every channel represents exactly, and the smallest step.
inline constexpr float kMaxRgb9e5 = 65408.0f;
inline constexpr float kMinRgb9e5 = 0x1p-24f;

/// Rounds a colour to a code. With `rounding` 1/2, rounds to nearest; with uniform random numbers in [0, 1), the mean
/// of many codes of one value is that value. Values are clamped to [0, kMaxRgb9e5]; NaN becomes 0.
[[nodiscard]] inline std::uint32_t to_rgb9e5(const Eigen::Vector3f& colour, float rounding = 0.5f) {
  Eigen::Vector3f c;
  for (int i = 0; i < 3; ++i) c[i] = colour[i] > 0.0f ? std::min(colour[i], kMaxRgb9e5) : 0.0f;
  const float largest = c.maxCoeff();
  int exponent = std::max(-15, largest > 0.0f ? std::ilogb(largest) + 1 : -15) + 15;
  const auto mantissa = [&](float value) {
    return static_cast<std::uint32_t>(std::floor(std::ldexp(value, 24 - exponent) + rounding));
  };
  if (mantissa(largest) > 511u && exponent < 31) ++exponent;
  std::uint32_t code = static_cast<std::uint32_t>(exponent) << 27;
  for (int i = 0; i < 3; ++i) code |= std::min(mantissa(c[i]), 511u) << (9 * i);
  return code;
}

/// Returns the value of a mantissa of 1.
[[nodiscard]] inline float step_of_rgb9e5(std::uint32_t code) {
  // The bits of the float 2^(exponent - 24), whose exponent is biased by 127:
  return std::bit_cast<float>(((code >> 27) + 103u) << 23);
}

[[nodiscard]] inline Eigen::Vector3f from_rgb9e5(std::uint32_t code) {
  return Eigen::Vector3f(static_cast<float>(code & 511u), static_cast<float>((code >> 9) & 511u),
                         static_cast<float>((code >> 18) & 511u)) *
         step_of_rgb9e5(code);
}

}  // namespace cyclorama::light
