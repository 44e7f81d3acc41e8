// SPDX-License-Identifier: Apache-2.0
/// Plans a scan for the room that installation.toml describes: the directions of the turntable, and the projectors to
/// measure in each direction.
///
///          direction 0    1    2         every lit part of the wall is seen from at least one direction,
///        ╲────┼───╱╲──┼──╱╲──┼───╱      and neighbouring directions overlap enough to be joined
#pragma once

#include <string>
#include <vector>

#include "appliance/solve/measurements.h"
#include "common/base/result.h"
#include "common/room/installation.h"
#include "drivers/turntable/turntable.h"

namespace cyclorama::scan {

struct ScanDirection {
  double angle_rad = 0.0;                 ///< Angle of the turntable.
  std::vector<std::size_t> projectors{};  ///< Indices of the projectors that should be seen.
};

struct ScanPlan {
  std::vector<ScanDirection> directions;
  double wall_distance_m = 0.0;        ///< Mean distance of the lit wall from the sweet spot.
  double wall_distance_sigma_m = 0.0;  ///< Standard deviation of that distance.
  std::vector<std::string> remarks;    ///< For the installer.
};

struct ScanPlanOptions {
  calibration::MeasuredLens camera;  ///< The focal length determines how much the camera sees in one direction.
  double pitch_rad = 0.0;            ///< Upward tilt of the camera.
  turntable::TurnRange range{-3.15, 3.15};
  int directions = 0;              ///< Number of directions; 0: as few as necessary.
  double min_overlap = 0.3;        ///< Minimum fraction of a direction's view that its neighbour also sees.
  double preferred_overlap = 0.5;  ///< Preferred overlap if there is a choice.
};

/// Returns evenly spaced directions, at least two, because a single direction cannot determine the camera's pose. The
/// camera is assumed to stand at the sweet spot; the rim of its picture is not used, since nothing stands exactly as
/// planned. Errors: kInvalidArgument, with the remedy, if no projector lights the wall or the camera sees too little of
/// the lit wall. Reentrant.
Result<ScanPlan> plan_scan(const Installation& installation, const ScanPlanOptions& options);

}  // namespace cyclorama::scan
