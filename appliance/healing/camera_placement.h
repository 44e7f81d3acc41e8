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
  std::string trouble{};  ///< Reason why the pose is unknown, and the remedy; empty if it is known.
};

/// Finds the poses of fixed cameras by patterns. Each camera pixel is matched to a projector pixel, and the wall's
/// calibration gives the position on the wall where that pixel lands.
///
///     camera pixel ─ patterns ─▶ projector pixel ─ its map ─▶ direction ─▶ wall ─▶ place_camera()
///
/// `calibration`'s maps must describe the projectors' present poses. A camera that cannot be placed is returned with
/// its trouble. Errors: kBadData if no camera can be placed, with the first camera's trouble; kUnavailable if `stop`
/// was requested ("cancelled") or a device fails; those of measure_view(). Blocks for about ten seconds per camera.
Result<std::vector<PlacedCamera>> place_cameras(const std::vector<WatchingCamera>& cameras, PlacementDevices& devices,
                                                const calibration::Calibration& calibration,
                                                const Installation& installation,
                                                const structured_light::ExposureLimits& exposure, std::stop_token stop);

}  // namespace cyclorama::healing
