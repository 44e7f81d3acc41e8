// SPDX-License-Identifier: Apache-2.0
/// Estimates the camera's pose from reference projectors, which have not been displaced since their calibration.
///
///     camera pixel ─▶ ray r ◀─ expected ─  R (d - n c)  ◀── direction d, from the reference projector's map
///                                           R: rotation, c: camera's centre, n: inverse distance of the wall along d
#pragma once

#include <Eigen/Core>
#include <span>

#include "appliance/solve/turntable.h"
#include "common/base/result.h"

namespace cyclorama::scan {

struct LocatedCamera {
  Eigen::Matrix3d R_camera_eye = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< Eye frame.
  Eigen::Vector3d centre_sigma_m = Eigen::Vector3d::Zero();
  bool is_elsewhere = false;  ///< True if the centre was estimated; otherwise it is that of the turntable's model.
  double rms_rad = 0.0;       ///< Per axis, over the observations used, without the worst twentieth.
  double heldout_rad = 0.0;   ///< Like `rms_rad`, over the observations that were left out.
};

/// Observation of one point of a reference projector's light.
struct ReferenceObservation {
  Eigen::Vector3d ray;         ///< Direction from the camera: camera frame, unit length.
  Eigen::Vector3d direction;   ///< Direction from the sweet spot, by the projector's map: Eye frame, unit length.
  double inverse_depth = 0.0;  ///< Inverse distance of the wall along `direction`, 1/m.
  double sigma_rad = 1e-4;     ///< Per axis.
  bool is_left_out = false;
};

/// Returns the pose that the calibrated turntable gives the camera at `angle_rad`.
[[nodiscard]] LocatedCamera planned_camera(const calibration::CalibratedTurntable& turntable, double angle_rad);

/// Estimates the camera's pose by robust least squares, starting at `planned`. A new centre is accepted only if it
/// differs significantly (three sigma) and predicts the left-out observations better; otherwise only the rotation is
/// estimated. Errors: kBadData if there are too few observations or no pose fits them. Reentrant.
Result<LocatedCamera> locate_camera(const LocatedCamera& planned, std::span<const ReferenceObservation> observations);

}  // namespace cyclorama::scan
