// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cyclorama::simulated {

/// What comes out of a projector's channel for a code value, or of a sensor's amplifier for a charge: both in [0, 1].
///
///   y = x / clip, at most 1        light = y^gamma + bend * y (1 - y) (1 - 2 y) - dip * exp(-((x - 0.85) / 0.05)^2)
///
/// A projector has a gamma of about 2.2 and an S-shaped bend; a camera for machine vision 1, one for people about
/// 1/2.2. A clip below 1 and a dip are what a wrongly set projector does. A value; reentrant.
struct TrueResponse {
  double gamma = 1.0;
  double bend = 0.0;
  double clip = 1.0;
  double dip = 0.0;

  /// In [0, 1] for every x.
  [[nodiscard]] double at(double x) const;
};

}  // namespace cyclorama::simulated
