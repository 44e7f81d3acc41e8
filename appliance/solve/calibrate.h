// SPDX-License-Identifier: Apache-2.0
/// Computes, from a scan's measurements, the maps with which displays draw.
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
  std::size_t wall_samples = 1200;  ///< Number of samples for the wall's fit, over all projectors.
  /// The previous calibration, whose maps are kept unless the new ones are better; may be null. Borrowed for the call.
  const calibration::Calibration* previous = nullptr;
};

/// Computes a calibration. Errors: those of Measurements::validate(), solve_turntable() and, with the projector's name,
/// fit_measured_map(). A wall that cannot be fitted is only a remark, since the maps do not need it. A projector that
/// was not seen is an error. Blocks; uses one thread per map and per cross-validation fold. The result does not depend
/// on thread timing. Reentrant.
Result<calibration::Calibration> calibrate(const Measurements& measurements, std::string date,
                                           const CalibrateOptions& options = {});

/// Returns the map for an eye at `eye_m` from the sweet spot (Eye frame), by the points of the wall that the projector
/// lights. Directions that miss the wall become NaN.
[[nodiscard]] calibration::MeasuredMap seen_from(const calibration::MeasuredMap& map, const calibration::Surface& wall,
                                                 const Eigen::Vector3d& eye_m);

}  // namespace cyclorama::solve
