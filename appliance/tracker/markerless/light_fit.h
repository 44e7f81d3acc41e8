// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cyclorama::tracker {

/// Change of a room's brightness: the logarithm of the gain as a second-degree polynomial over the picture, where x and
/// y run from -1 to 1. It approximates a lamp that is switched on, a camera that adjusts its gain, and a wall that
/// changes its colour. A value.
struct LightGain {
  /// Coefficients of 1, x, y, x², xy, y².
  Eigen::Matrix<double, 6, 1> coefficients = Eigen::Matrix<double, 6, 1>::Zero();

  [[nodiscard]] static Eigen::Matrix<double, 6, 1> terms(double x, double y) {
    return (Eigen::Matrix<double, 6, 1>() << 1.0, x, y, x * x, x * y, y * y).finished();
  }
  [[nodiscard]] double at(double x, double y) const { return coefficients.dot(terms(x, y)); }
};

/// Logarithm of a cell's brightness relative to the empty room's.
struct LogLightSample {
  double x = 0.0;
  double y = 0.0;
  double log_ratio = 0.0;
  double weight = 1.0;  ///< 0 where a person may stand.
};

/// Returns the gain that most samples agree on; a person in front of the room is an outlier as long as less than half
/// of the samples are covered. Iterated least squares with Cauchy's weights, starting at the median. No change if there
/// are no samples. Pure.
[[nodiscard]] LightGain fitted_light(const std::vector<LogLightSample>& samples);

}  // namespace cyclorama::tracker
