// SPDX-License-Identifier: Apache-2.0
/// Where the camera stands now, told by projectors that stand where they were calibrated:
///
///     camera's pixel ─▶ ray r ◀── should be ──  R (d - n c)  ◀── direction d, which a witness's map gives its pixel
///                                               turned by R, from the centre c; n is how near the wall is along d
#pragma once

#include <Eigen/Core>
#include <span>

#include "appliance/solve/turntable.h"
#include "common/base/result.h"

namespace cyclorama {

struct CameraStand {
  Eigen::Matrix3d R_camera_eye = Eigen::Matrix3d::Identity();
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< Eye frame.
  Eigen::Vector3d centre_sigma_m = Eigen::Vector3d::Zero();
  bool is_elsewhere = false;  ///< Its centre was found anew; else it is where the plate should have it.
  double rms_rad = 0.0;       ///< Per axis, of witnesses that were used, without the worst twentieth,
  double heldout_rad = 0.0;   ///< and of those that were left out.
};

/// What one place of a witness's light tells.
struct WitnessSight {
  Eigen::Vector3d ray;        ///< Where the camera sees it: camera frame, unit length.
  Eigen::Vector3d direction;  ///< Where the sweet spot does, by the witness's map: unit length.
  double nearness = 0.0;      ///< Of the wall there, 1/m.
  double sigma_rad = 1e-4;    ///< Each way.
  bool is_left_out = false;
};

/// Where a calibrated plate has the camera when it stands at `angle_rad`.
[[nodiscard]] CameraStand planned_stand(const TurnPlate& plate, double angle_rad);

/// Robust least squares from `planned`: a turn alone, or with another centre where that is clear (three sigma) and
/// predicts what was left out better. kBadData  too few witnesses, or no stand goes with them. Reentrant.
Result<CameraStand> find_stand(const CameraStand& planned, std::span<const WitnessSight> sights);

}  // namespace cyclorama
