// SPDX-License-Identifier: Apache-2.0
/// The scan's second half: how bright each projector is, and which colours it has.
///
///     for each direction:  turn ─▶ for each projector that was seen from here:  black, white
///                                    and once, where it was seen best:           ramps of red, green, blue
///                                        each at several exposures ─▶ ProjectorView, for photometry()
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "appliance/photometry/photometry_input.h"
#include "appliance/scan/scan_view.h"
#include "appliance/scan/wall_scan.h"
#include "common/room/installation.h"

namespace cyclorama::scan {

struct LightScan {
  /// All but the projectors' maps, which are not known yet.
  photometry::PhotometryInput input;
  int pictures = 0;
};

/// `views` as scan_wall() gave them tell which pixels of the camera see which projector. What the projectors have is
/// photographed in colour where ScanDevices has a camera for it. Whatever happens, no pattern is left on the wall.
/// kUnavailable  cancelled, or a device is gone.   kBadData  no exposure at which white is not clipped: says what to
/// do. Others as Turntable's. Blocks, for a minute or two.
Result<LightScan> scan_light(const Installation& installation, std::span<const ScanView> views,
                             const structured_light::ExposureLimits& limits, const ScanDevices& devices,
                             const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
