// SPDX-License-Identifier: Apache-2.0
/// Residual errors of a calibration, for shows that continue from one: the truth passes through the calibrator's own
/// processing of a measured wall (fit_projector, place_camera), with errors of the measured size.
#pragma once

#include "appliance/calibration/show_calibration.h"
#include "common/base/result.h"
#include "drivers/simulated/museum/flaws.h"

namespace cyclorama {

struct LeftOver {
  double map_px = 0.04;  ///< Standard deviation of each measured direction, in projector pixels per axis (at 1080p).
  double sweet_spot_m = 2e-3;     ///< Upper bound per axis on the difference between the eye and installation.toml.
  double camera_focal = 2e-4;     ///< Upper bound, relative: the residual of cyclorama-calibrate-camera.
  double camera_centre_px = 0.3;  ///< Upper bound.
  /// Standard deviation of each correspondence that locates a camera, in camera pixels per axis.
  double camera_pixel_px = 0.1;
};

/// Returns what a calibration would know of `truth`. Errors: those of fit_projector() and place_camera().
Result<calibration::ShowCalibration> calibrated(const calibration::ShowCalibration& truth, const LeftOver& left,
                                                simulated::RandomStream draws);

/// Returns the position that `room` assigns to a true point of the wall, as seen from the sweet spot of `truth`.
[[nodiscard]] std::optional<Eigen::Vector3d> believed_position(const calibration::ShowCalibration& truth,
                                                               const calibration::ShowCalibration& room,
                                                               const Eigen::Vector3d& position);

}  // namespace cyclorama
