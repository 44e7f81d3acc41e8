// SPDX-License-Identifier: Apache-2.0
/// The second half of a scan: brightness and colours of each projector.
///
///     for each direction:  turn ─▶ for each projector that was seen from here:  black, white
///                                    and once, from where it is seen best:       ramps of red, green, blue
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
  /// Everything except the projectors' maps, which are not known yet.
  photometry::PhotometryInput input;
  int pictures = 0;
};

/// Photographs each projector for photometry(). `views` are those of scan_wall(); they give the camera pixels that see
/// each projector. Photographs are taken in colour if ScanDevices has a colour camera. On return, also after an error,
/// all projectors are dark. Errors: kUnavailable if `stop` was requested or a device is gone; kBadData if white is
/// clipped at every exposure (with the remedy); otherwise those of Turntable. Blocks for a minute or two.
Result<LightScan> scan_light(const Installation& installation, std::span<const ScanView> views,
                             const structured_light::ExposureLimits& limits, const ScanDevices& devices,
                             const ScanListener& listener, std::stop_token stop);

}  // namespace cyclorama::scan
