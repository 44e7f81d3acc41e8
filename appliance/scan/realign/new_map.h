// SPDX-License-Identifier: Apache-2.0
/// From a realignment's photographs to the displaced projector's new map, in steps that pass values:
///
///     photographs ─▶ cells ─▶ locate_camera() ─▶ directions of the projector's pixels ─▶ find_displacement()
///                                                        │                                      │ fills what
///                                                        ▼                                      ▼ is not seen
///                                   a map that predicts left-out blocks better than the old one: the new map
#pragma once

#include <optional>

#include "appliance/scan/realign/baseline.h"
#include "appliance/scan/realign/photographs.h"
#include "appliance/scan/realign/projector_displacement.h"
#include "appliance/solve/registration.h"

namespace cyclorama::scan {

/// A map that follows a displacement.
struct DisplacedMap {
  calibration::MeasuredMap map;
  Displacement displacement;
  solve::MeasuredRegistration registration;  ///< Over correspondences that no map was fitted to.
  double seen_fraction = 1.0;                ///< Part of the map that was measured; the displacement gives the rest.
};

struct NewMap {
  /// With the old map, over the same correspondences as DisplacedMap::registration.
  solve::MeasuredRegistration before;
  double camera_moved_m = 0.0;  ///< Distance of the camera from its planned centre; 0 where that is not clear.
  std::optional<DisplacedMap> displaced;  ///< Absent if the old map still predicts what is seen.
  double old_error_px = 0.0;              ///< Error of the old map; set only if that map still holds.
};

/// Errors: kBadData, each with its remedy, if the camera's pose was not found, the lens was turned, no displacement
/// explains the photographs, the new map would be no better, or too little was seen. Takes seconds. Reentrant.
Result<NewMap> find_new_map(const RealignmentBaseline& baseline, const RealignmentPhotographs& photographs);

}  // namespace cyclorama::scan
