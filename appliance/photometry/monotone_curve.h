// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama::photometry {

/// A curve through points with continuous slope that is monotone between adjacent points. Source: Fritsch and Carlson,
/// "Monotone Piecewise Cubic Interpolation", SIAM J. Numer. Anal. 17 (2), 1980. A value; reentrant.
class MonotoneCurve {
 public:
  /// Creates the curve through points (x, y). Precondition: at least two points, with increasing x.
  MonotoneCurve(std::vector<double> x, std::vector<double> y);
  /// Returns the curve's value; beyond the points, the value at the nearest end.
  [[nodiscard]] double at(double x) const;

 private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slope_;
};

}  // namespace cyclorama::photometry
