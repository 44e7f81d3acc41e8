// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

namespace cyclorama::photometry {

/// Weights and derivatives of the four coefficients that determine a uniform cubic B-spline at one point.
struct CubicWeights {
  int first = 0;  ///< Index of the first of these coefficients, of which there are intervals + 3.
  std::array<double, 4> value{};
  std::array<double, 4> slope{};  ///< Derivatives by x, in intervals.
};

/// Returns the weights at `x`, which counts intervals; it is clamped to [0, intervals].
[[nodiscard]] inline CubicWeights cubic_weights(double x, int intervals) {
  const double at = x > 0.0 ? std::min(x, static_cast<double>(intervals)) : 0.0;
  CubicWeights w;
  w.first = std::min(static_cast<int>(at), intervals - 1);
  const double t = at - w.first;
  const double u = 1.0 - t;
  w.value = {u * u * u / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
             t * t * t / 6.0};
  w.slope = {-0.5 * u * u, 1.5 * t * t - 2.0 * t, -1.5 * u * u + 2.0 * u, 0.5 * t * t};
  return w;
}

}  // namespace cyclorama::photometry
