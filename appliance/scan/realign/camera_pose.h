// SPDX-License-Identifier: Apache-2.0
/// The camera's pose, found by reference projectors: those that did not move since they were calibrated.
///
///     camera's pixel ─▶ ray r ◀── should be ──  R (d - n c)  ◀── direction d, by the reference projector's map
///                                               R: rotation, c: camera's centre, n: inverse distance of the wall along d
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
  bool is_elsewhere = false;  ///< The centre was estimated; otherwise it is the one that the turntable's model gives.
  double rms_rad = 0.0;       ///< Per axis, over observations that were used, without the worst twentieth.
  double heldout_rad = 0.0;   ///< The same over observations that were left out.
};

/// One point of a reference projector's light.
struct ReferenceObservation {
  Eigen::Vector3d ray;         ///< Direction from the camera: camera frame, unit length.
  Eigen::Vector3d direction;   ///< Direction from the sweet spot, by the projector's map: Eye frame, unit length.
  double inverse_depth = 0.0;  ///< Inverse distance of the wall there, 1/m.
  double sigma_rad = 1e-4;     ///< Per axis.
  bool is_left_out = false;
};

/// The pose that the calibrated turntable gives the camera at `angle_rad`.
[[nodiscard]] LocatedCamera planned_camera(const calibration::CalibratedTurntable& turntable, double angle_rad);

/// Robust least squares from `planned`: a rotation alone, or a rotation and another centre where the latter is clear
/// (three sigma) and predicts the observations that were left out better.
/// kBadData  there are too few observations, or no pose fits them. Reentrant.
Result<LocatedCamera> locate_camera(const LocatedCamera& planned, std::span<const ReferenceObservation> observations);

}  // namespace cyclorama::scan
