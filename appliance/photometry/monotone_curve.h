// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama::photometry {

/// A curve with continuous slope through points that never overshoots them: it is monotone between points. Source:
/// Fritsch and Carlson, "Monotone Piecewise Cubic Interpolation", SIAM J. Numer. Anal. 17 (2), 1980. A value;
/// reentrant.
class MonotoneCurve {
 public:
  /// Precondition: at least two points, with increasing x.
  MonotoneCurve(std::vector<double> x, std::vector<double> y);
  /// Outside the points, returns the value at the nearest end.
  [[nodiscard]] double at(double x) const;

 private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slope_;
};

}  // namespace cyclorama::photometry
