// SPDX-License-Identifier: Apache-2.0
/// Where the turntable stops, and which projectors are looked at from there: decided before anything moves, by what
/// installation.toml says of the room.
///
///          direction 0    1    2         every place that is lit is seen from one direction at least,
///        ╲────┼───╱╲──┼──╱╲──┼───╱      and neighbours share enough to hang together
#pragma once

#include <string>
#include <vector>

#include "appliance/solve/measurements.h"
#include "common/base/result.h"
#include "common/room/installation.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::scan {

struct ScanDirection {
  double angle_rad = 0.0;                 ///< Of the turntable.
  std::vector<std::size_t> projectors{};  ///< Those that should be seen, by number.
};

struct ScanPlan {
  std::vector<ScanDirection> directions;
  double wall_distance_m = 0.0;        ///< From the sweet spot, mean of what is lit.
  double wall_distance_sigma_m = 0.0;  ///< How much it differs.
  std::vector<std::string> remarks;    ///< For the installer.
};

struct ScanPlanOptions {
  calibration::MeasuredLens camera;  ///< Its focal length decides how much one direction sees.
  double pitch_rad = 0.0;            ///< How far it looks up.
  turntable::TurnRange range{-3.15, 3.15};
  int directions = 0;              ///< 0: as few as it takes.
  double min_overlap = 0.3;        ///< Of what a direction sees, so much its neighbour sees too;
  double preferred_overlap = 0.5;  ///< where there is a choice, so much.
};

/// Evenly spaced directions. The camera is taken to stand on the sweet spot; the rim of its picture is not relied upon,
/// since nothing stands exactly as planned. Two directions at least: one alone cannot tell how the camera stands.
/// kInvalidArgument  no projector lights the wall, or the camera sees too little of what is lit: says what to change.
/// Reentrant.
Result<ScanPlan> plan_scan(const Installation& installation, const ScanPlanOptions& options);

}  // namespace cyclorama::scan
