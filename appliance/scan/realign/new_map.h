// SPDX-License-Identifier: Apache-2.0
/// Computes the displaced projector's new map from a realignment's photographs:
///
///     photographs ─▶ cells ─▶ locate_camera() ─▶ directions of the projector's pixels ─▶ find_displacement()
///                                                        │                                      │ fills parts
///                                                        ▼                                      ▼ not seen
///                                   a map that predicts left-out blocks better than the old one: the new map
#pragma once

#include <optional>

#include "appliance/scan/realign/baseline.h"
#include "appliance/scan/realign/photographs.h"
#include "appliance/scan/realign/projector_displacement.h"
#include "appliance/solve/registration.h"

namespace cyclorama::scan {

/// New map of a displaced projector.
struct DisplacedMap {
  calibration::MeasuredMap map;
  Displacement displacement;
  solve::MeasuredRegistration registration;  ///< Measured with correspondences to which the map was not fitted.
  double seen_fraction = 1.0;                ///< Measured fraction of the map.
};

struct NewMap {
  /// Registration with the old map, over the correspondences of DisplacedMap::registration.
  solve::MeasuredRegistration before;
  double camera_moved_m = 0.0;  ///< Distance of the camera from its planned centre; 0 if it is not significant.
  std::optional<DisplacedMap> displaced;  ///< Absent if the old map still predicts the observations.
  double old_error_px = 0.0;              ///< Error of the old map; set only if `displaced` is absent.
};

/// Computes the new map. Errors: kBadData, with a remedy for each case, if the camera's pose was not found, the lens
/// was turned, no displacement explains the photographs, the new map would not be better, or too little was seen. Takes
/// seconds. Reentrant.
Result<NewMap> find_new_map(const RealignmentBaseline& baseline, const RealignmentPhotographs& photographs);

}  // namespace cyclorama::scan
