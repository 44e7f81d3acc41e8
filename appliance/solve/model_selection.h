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
  double tolerance =
      calibration::kMinModelGain;  ///< A lesser wall may be so much worse on what it was not shown, as a share,
  double tolerance_px = 0.005;     ///< or by so much: nobody sees that.
  double lens_tolerance_px = 0.02;
  double max_scatter = 0.02;
  double knot_rad = 0.1;  ///< Between control points of a profile and of a mesh.

  /// The largest left-out error of a lesser wall that stays where the best wall's is `best_px`.
  [[nodiscard]] double allows(double best_px) const { return best_px + std::max(tolerance * best_px, tolerance_px); }
};

/// Climbs the selection of surfaces, then that of lenses. A fold leaves out whole squares of a projector's picture, so
/// that a rich model has to bridge them. kBadData  no model fits. Errors of surface_start(). Reentrant.
Result<calibration::ModelChoice> choose_model(const std::vector<MeasuredProjector>& projectors,
                                              std::span<const MapSample> samples, double wall_distance_m,
                                              const ModelOptions& options = {});

}  // namespace cyclorama::solve
