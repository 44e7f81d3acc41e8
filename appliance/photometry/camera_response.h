// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama::photometry {

/// The light that makes a camera's code, in parts of what makes its highest; 0 in darkness, so perhaps below 0 for
/// code 0. A cubic spline over the code. A value; reentrant.
struct CameraResponse {
  std::vector<double> coefficients{};  ///< At least four.

  static CameraResponse linear(int intervals);
  [[nodiscard]] int intervals() const { return static_cast<int>(coefficients.size()) - 3; }
  /// `code` outside [0, 1] counts as the end.
  [[nodiscard]] double light_of(double code) const;
  [[nodiscard]] double slope_at(double code) const;
  /// The least code whose light is not below 0.
  [[nodiscard]] double dark_code() const;
};

}  // namespace cyclorama::photometry
