// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cyclorama::simulated {

/// Response of a projector's channel to a code value, or of a sensor's amplifier to a charge; both in [0, 1].
///
///   y = x / clip, at most 1        light = y^gamma + bend * y (1 - y) (1 - 2 y) - dip * exp(-((x - 0.85) / 0.05)^2)
///
/// A projector has a gamma of about 2.2 and an S-shaped bend; a machine-vision camera has a gamma of 1, a consumer
/// camera about 1/2.2. A clip below 1 and a dip occur with wrong projector settings. A value; reentrant.
struct TrueResponse {
  double gamma = 1.0;
  double bend = 0.0;
  double clip = 1.0;
  double dip = 0.0;

  /// Returns the response to x; in [0, 1] for every x.
  [[nodiscard]] double at(double x) const;
};

}  // namespace cyclorama::simulated
