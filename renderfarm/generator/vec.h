// SPDX-License-Identifier: Apache-2.0
/// Small vectors and interpolation for the generator. Metres; y up; colours are sRGB code values in [0, 1].
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama::generator {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;

inline constexpr float kPi = std::numbers::pi_v<float>;

/// Returns exactly `a` at t = 0 and `b` at t = 1, so that patches meet without rounding errors.
[[nodiscard]] inline float mix(float a, float b, float t) { return a * (1.0f - t) + b * t; }
[[nodiscard]] inline Vec3 mix(const Vec3& a, const Vec3& b, float t) { return a + (b - a) * t; }
[[nodiscard]] inline float unit_clamp(float x) { return std::clamp(x, 0.0f, 1.0f); }

/// Returns 0 below `from`, 1 above `to`, and a smooth transition between; `from` may exceed `to`.
[[nodiscard]] inline float smooth_step(float from, float to, float x) {
  const float t = unit_clamp((x - from) / (to - from));
  return t * t * (3.0f - 2.0f * t);
}

/// Returns 1 inside [from, to], with a smooth transition to 0 over `edge` on both sides.
[[nodiscard]] inline float smooth_window(float from, float to, float edge, float x) {
  return smooth_step(from - edge, from + edge, x) * (1.0f - smooth_step(to - edge, to + edge, x));
}

}  // namespace cyclorama::generator
