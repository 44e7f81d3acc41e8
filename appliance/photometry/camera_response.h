// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama::photometry {

/// Light as a function of the camera's code: a cubic spline over the code. Light is relative to that of the highest
/// code, and 0 in darkness, so code 0 may have negative light. A value; reentrant.
struct CameraResponse {
  std::vector<double> coefficients{};  ///< At least four.

  static CameraResponse linear(int intervals);
  [[nodiscard]] int intervals() const { return static_cast<int>(coefficients.size()) - 3; }
  /// Returns the light of a code, which is clamped to [0, 1].
  [[nodiscard]] double light_of(double code) const;
  [[nodiscard]] double slope_at(double code) const;
  /// Returns the smallest code whose light is not negative.
  [[nodiscard]] double dark_code() const;
};

}  // namespace cyclorama::photometry
