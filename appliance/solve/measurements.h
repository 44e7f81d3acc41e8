// SPDX-License-Identifier: Apache-2.0
/// What the camera on the turntable saw, as the decoder hands it to the solver.
///
///     turntable's axis (y)          a direction = one angle of the turntable; in it
///          │  . heading              camera pixel ──▶ projector, and the projector's pixel that lights what is there
///          │ /
///     ─────┼──── camera: turned with the turntable, its centre off the axis by (right, forward), pitched and rolled
///
/// CameraFrame: Eye (x right, y up along the turntable's axis, z back), its origin where the axis passes the camera's
/// height: the sweet spot. Angles are headings: positive to the right.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/measured_lens.h"
#include "common/base/result.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama::solve {

/// The camera's pixel is exact; the projector's has noise of `sigma_px` each way.
struct Correspondence {
  float camera_u = 0.0f;
  float camera_v = 0.0f;
  float projector_x = 0.0f;
  float projector_y = 0.0f;
  float sigma_px = 0.3f;
  std::uint32_t projector = 0;  ///< Counts Measurements::projectors.
};

struct TurntableDirection {
  double angle_rad = 0.0;     ///< As the turntable tells.
  double sigma_rad = 1.0e-3;  ///< How far that may be wrong.
  std::vector<Correspondence> correspondences;
};

/// Where a projector stands as the installation has it: where the search begins, and how far it may go.
struct ProjectorPosePrior {
  calibration::MeasuredLens lens;
  RigidTransform<frame::Eye, frame::Projector> T_eye_projector;
  double sigma_m = 0.3;
  double sigma_rad = 0.09;
};

struct MeasuredProjector {
  std::string name;
  int width_px = 0;
  int height_px = 0;
  std::optional<ProjectorPosePrior> position{};  ///< Only a fitted surface needs it.
};

struct Measurements {
  calibration::MeasuredLens camera;  ///< With the covariance that its own calibration left.
  double pitch_rad = 0.0;            ///< How far the camera looks up, about; the solver finds it and the roll.
  std::vector<TurntableDirection> directions;
  std::vector<MeasuredProjector> projectors;
  double wall_distance_m = 4.0;        ///< From the sweet spot to the wall, about: lengths are measured by it.
  double wall_distance_sigma_m = 1.0;  ///< How much it differs along the wall, and is wrong.

  /// kInvalidArgument  with the direction, projector or correspondence at fault, and what to do.
  [[nodiscard]] Status validate() const;
};

}  // namespace cyclorama::solve
