// SPDX-License-Identifier: Apache-2.0
/// The photographs of a realignment: the displaced projector's patterns, then sines on all reference projectors.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "appliance/scan/realign/baseline.h"
#include "appliance/scan/realign/camera_pose.h"
#include "appliance/scan/realign/reference_view.h"
#include "appliance/scan/wall_scan.h"

namespace cyclorama::scan {

struct RealignmentPhotographs {
  LocatedCamera planned;     ///< Pose of the camera according to the turntable's commanded angle.
  ScanView target;           ///< Measured with the displaced projector's own patterns.
  ReferenceView references;  ///< Measured with sines on the other projectors.
  int pictures = 0;
  int retries = 0;
  std::vector<std::string> remarks;  ///< For the installer.
};

/// Turns the camera to where it sees all of the displaced projector's light and as much as possible of the other
/// projectors' light. On success, all projectors are dark on return. Errors: kUnavailable if the projector gives no
/// light or `stop` was requested; otherwise those of measure_view() and Turntable. Blocks.
Result<RealignmentPhotographs> photograph_displaced(const RealignmentBaseline& baseline,
                                                    const Installation& installation, const ScanSettings& settings,
                                                    const ScanDevices& devices, const ScanListener& listener,
                                                    const std::stop_token& stop);

}  // namespace cyclorama::scan
