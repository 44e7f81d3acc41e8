// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/structured_light/edge_interpolation.h"
#include "appliance/structured_light/photo.h"

namespace cyclorama::structured_light {

/// Accumulates the shifted sines of one axis, which give the position within a period independently of the wall's
/// colour.
class PhaseReading {
 public:
  PhaseReading() = default;
  PhaseReading(double period_px, int steps) : period_px_(period_px), steps_(steps) {}

  void add(int step, const Photo& photo);
  [[nodiscard]] bool is_complete() const { return steps_ > 0 && seen_ == steps_; }
  /// Replaces positions from the bits by positions from the phase where these are more accurate. A pixel whose two
  /// positions differ by more than a quarter of a period loses its position.
  void refine(double noise, AxisPositions* positions) const;

 private:
  double period_px_ = 0.0;
  int steps_ = 0;
  int seen_ = 0;
  Image<float, 2> sums_;  ///< Sums of light times cosine and sine of each step's angle.
};

}  // namespace cyclorama::structured_light
