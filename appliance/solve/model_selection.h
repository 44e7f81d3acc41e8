// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "appliance/solve/surface_fit.h"

namespace cyclorama::solve {

struct ModelOptions {
  int folds = 3;
  /// A smaller wall model is accepted if its left-out error exceeds the best model's by at most this fraction, or by
  /// `tolerance_px`, which is invisible.
  double tolerance = calibration::kMinModelGain;
  double tolerance_px = 0.005;
  double lens_tolerance_px = 0.02;
  double max_scatter = 0.02;
  double knot_rad = 0.1;  ///< Spacing of the control points of a profile and of a mesh.

  /// Returns the largest left-out error with which a smaller wall model is accepted if the best model's is `best_px`.
  [[nodiscard]] double allows(double best_px) const { return best_px + std::max(tolerance * best_px, tolerance_px); }
};

/// Selects the surface model, then the lens model, by cross-validation. A fold leaves out whole squares of a
/// projector's picture, across which a rich model must interpolate. Errors: kBadData if no model fits; otherwise those
/// of surface_start(). Reentrant.
Result<calibration::ModelChoice> choose_model(const std::vector<MeasuredProjector>& projectors,
                                              std::span<const MapSample> samples, double wall_distance_m,
                                              const ModelOptions& options = {});

}  // namespace cyclorama::solve
