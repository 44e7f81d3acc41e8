// SPDX-License-Identifier: Apache-2.0
/// From what was measured to what the displays draw with.
///
///     correspondences ─▶ cell means ─▶ turntable ─▶ directions ─┬─▶ a map per projector (always)
///                                                                 └─▶ wall and projectors' places (if asked) ─▶ maps
///                                                                     for other eyes
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
  std::size_t wall_samples = 1200;                     ///< Over all projectors.
  const calibration::Calibration* previous = nullptr;  ///< Never a worse map than before. Borrowed for the call.
};

/// Errors of Measurements::validate(), solve_turntable() and, with the projector's name, fit_measured_map(). A wall
/// that cannot be found is a remark: the maps need none. Projectors that were not seen at all are an error. A thread
/// for each map and each fold works while it blocks; the answer does not depend on them. Reentrant.
Result<calibration::Calibration> calibrate(const Measurements& measurements, std::string date,
                                           const CalibrateOptions& options = {});

/// The same map for an eye that is `eye_m` from the sweet spot (Eye frame): the wall tells where the light lands.
/// NaN where the wall has no place. Precondition: a wall.
[[nodiscard]] calibration::MeasuredMap seen_from(const calibration::MeasuredMap& map, const calibration::Surface& wall,
                                                 const Eigen::Vector3d& eye_m);

}  // namespace cyclorama::solve
