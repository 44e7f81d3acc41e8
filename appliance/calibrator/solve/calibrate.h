// SPDX-License-Identifier: Apache-2.0
/// From what was measured to what the displays draw with.
///
///     correspondences ─▶ cell means ─▶ turn-plate ─▶ directions ─┬─▶ a map per projector (always)
///                                                                 └─▶ wall and projectors' places (if asked) ─▶ maps
///                                                                     for other eyes
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "appliance/calibrator/solve/measured_map.h"
#include "appliance/calibrator/solve/model_choice.h"
#include "appliance/calibrator/solve/turn_plate.h"

namespace cyclorama {

struct CalibratedProjector {
  std::string name;
  MeasuredMap map;
  bool is_previous = false;  ///< The map of before predicted the new measurements better, and stays.
};

struct Calibration {
  std::string date;  ///< "2026-11-22T13-05-00Z": also a folder's name.
  TurnPlate plate;
  std::vector<CalibratedProjector> projectors;
  std::optional<ModelChoice> wall;   ///< Absent where it was not asked for, or could not be found.
  std::vector<std::string> remarks;  ///< For the installer: what is not as it could be, and what to do.
};

struct CalibrateOptions {
  bool with_wall = true;
  TurnPlateOptions plate{};
  MapOptions map{};
  ModelOptions model{};
  std::size_t wall_samples = 1200;        ///< Over all projectors.
  const Calibration* previous = nullptr;  ///< Never a worse map than before. Borrowed for the call.
};

/// Errors of Measurements::validate(), solve_turn_plate() and, with the projector's name, fit_measured_map(). A wall
/// that cannot be found is a remark: the maps need none. Projectors that were not seen at all are an error. A thread
/// for each map and each fold works while it blocks; the answer does not depend on them. Reentrant.
Result<Calibration> calibrate(const Measurements& measurements, std::string date, const CalibrateOptions& options = {});

/// The same map for an eye that is `eye_m` from the sweet spot (Eye frame): the wall tells where the light lands.
/// NaN where the wall has no place. Precondition: a wall.
[[nodiscard]] MeasuredMap seen_from(const MeasuredMap& map, const Surface& wall, const Eigen::Vector3d& eye_m);

}  // namespace cyclorama
