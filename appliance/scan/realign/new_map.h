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
  solve::MeasuredRegistration registration;  ///< Over places that no map was fitted to.
  double seen_fraction = 1.0;                ///< Part of the map that was measured; the displacement gives the rest.
};

struct NewMap {
  solve::MeasuredRegistration before;  ///< With the old map, over the same places as DisplacedMap::registration.
  double camera_moved_m = 0.0;         ///< Distance of the camera from its planned centre; 0 where that is not clear.
  std::optional<DisplacedMap> displaced;  ///< Nothing where the old map still predicts what is seen.
  double old_error_px = 0.0;              ///< The old map's error; set only where that map still holds.
};

/// kBadData  the camera's pose was not found, the lens was turned, no displacement explains what is seen, the new map
/// would be no better, or too little was seen; each with its remedy. Takes seconds. Reentrant.
Result<NewMap> find_new_map(const RealignmentBaseline& baseline, const RealignmentPhotographs& photographs);

}  // namespace cyclorama::scan
