// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "appliance/healing/show_room.h"
#include "appliance/solve/calibrate.h"
#include "appliance/structured_light/exposure.h"
#include "common/room/installation.h"

namespace cyclorama::healing {

struct PlacedCamera {
  std::string name;
  calibration::BrownParameters lens;
  RigidTransform<frame::Room, frame::Camera> T_room_camera;
  std::size_t correspondences = 0;
  double rms_px = 0.0;
  std::string trouble{};  ///< Why nobody knows where it stands, and what to do; empty: it is known.
};

/// Where fixed cameras stand, by patterns: each projector that a camera sees tells where on the wall its pixels look,
/// since the wall's calibration says where the projector's land.
///
///     camera pixel ─ patterns ─▶ projector pixel ─ its map ─▶ direction ─▶ wall ─▶ place_camera()
///
/// `calibration`'s maps are where the projectors stand now.
/// A camera that sees too little of what is lit keeps no other from being placed.
/// kBadData  all of them do, with the first one's name.     kUnavailable  `stop`, with "cancelled", or a device. Others
/// as measure_view(). Blocks, for some ten seconds per camera.
Result<std::vector<PlacedCamera>> place_cameras(const std::vector<WatchingCamera>& cameras, PlacementDevices& devices,
                                                const calibration::Calibration& calibration,
                                                const Installation& installation,
                                                const structured_light::ExposureLimits& exposure, std::stop_token stop);

}  // namespace cyclorama::healing
