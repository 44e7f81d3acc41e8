// SPDX-License-Identifier: Apache-2.0
/// What a calibration leaves over, for shows that go on from one: the truth goes through what the calibrator itself
/// does with a measured wall (fit_projector, place_camera), with errors as large as were measured of it.
#pragma once

#include "appliance/calibration/show_calibration.h"
#include "common/base/result.h"
#include "drivers/simulated/museum/flaws.h"

namespace cyclorama {

struct LeftOver {
  double map_px = 0.04;           ///< Of each measured direction, in pixels of the projector, each way (of 1080p).
  double sweet_spot_m = 2e-3;     ///< The eye is not quite where installation.toml says, each axis, at most.
  double camera_focal = 2e-4;     ///< Part of it, at most: what cyclorama-calibrate-camera leaves.
  double camera_centre_px = 0.3;  ///< At most.
  double camera_pixel_px = 0.1;   ///< Of each place by which a camera is placed, in its pixels, each way.
};

/// `truth` in the words of a calibration; the answer is what a calibration knows of it. Errors as those of
/// fit_projector() and place_camera().
Result<calibration::ShowCalibration> calibrated(const calibration::ShowCalibration& truth, const LeftOver& left,
                                                simulated::RandomStream draws);

/// Where `room` takes a true place on the wall to be, as seen from the sweet spot of `truth`.
[[nodiscard]] std::optional<Eigen::Vector3d> believed_position(const calibration::ShowCalibration& truth,
                                                               const calibration::ShowCalibration& room,
                                                               const Eigen::Vector3d& position);

}  // namespace cyclorama
