// SPDX-License-Identifier: Apache-2.0
/// From a scan's measurements to the maps that the displays draw with.
///
///     correspondences ─▶ cell means ─▶ turntable ─▶ directions ─┬─▶ a map per projector (always)
///                                                               └─▶ wall and projectors' poses (optional) ─▶ maps
///                                                                   for other eyes
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/calibration.h"
#include "appliance/solve/map_fit.h"
#include "appliance/solve/model_selection.h"
#include "appliance/solve/turntable.h"

namespace cyclorama::solve {

struct CalibrateOptions {
  bool with_wall = true;
  TurntableSolverOptions turntable{};
  MapOptions map{};
  ModelOptions model{};
  std::size_t wall_samples = 1200;  ///< Total over all projectors.
  /// A map worse than the previous one is not taken. Borrowed for the call.
  const calibration::Calibration* previous = nullptr;
};

/// Errors: those of Measurements::validate(), solve_turntable() and, with the projector's name, fit_measured_map(). If
/// the wall cannot be fitted, a remark says so, since the maps need no wall. A projector that was not seen at all is an
/// error. Blocks; uses one thread per map and per cross-validation fold. The result does not depend on thread timing.
/// Reentrant.
Result<calibration::Calibration> calibrate(const Measurements& measurements, std::string date,
                                           const CalibrateOptions& options = {});

/// Returns the same map for an eye at `eye_m` from the sweet spot (Eye frame); the wall gives the points that the
/// projector lights. Directions that miss the wall become NaN. Precondition: a wall.
[[nodiscard]] calibration::MeasuredMap seen_from(const calibration::MeasuredMap& map, const calibration::Surface& wall,
                                                 const Eigen::Vector3d& eye_m);

}  // namespace cyclorama::solve
