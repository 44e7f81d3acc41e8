// SPDX-License-Identifier: Apache-2.0
/// Measurements of a scan: the solver's input.
///
///     turntable's axis (y)      a direction = one angle of the turntable; it gives correspondences
///          │  . heading              camera pixel ──▶ projector, and the projector's pixel that lights that point
///          │ /
///     ─────┼──── camera: turned with the turntable, its centre off the axis by (right, forward), pitched and rolled
///
/// Frame: Eye (x right, y up along the turntable's axis, z back); its origin, the sweet spot, is on the axis at the
/// camera's height. Angles are headings: positive to the right.
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

/// A camera pixel, which is exact, and the projector's pixel that it sees, whose noise is `sigma_px` per axis.
struct Correspondence {
  float camera_u = 0.0f;
  float camera_v = 0.0f;
  float projector_x = 0.0f;
  float projector_y = 0.0f;
  float sigma_px = 0.3f;
  std::uint32_t projector = 0;  ///< Index in Measurements::projectors.
};

struct TurntableDirection {
  double angle_rad = 0.0;     ///< Reported by the turntable.
  double sigma_rad = 1.0e-3;  ///< Standard deviation of that angle.
  std::vector<Correspondence> correspondences;
};

/// Prior pose of a projector, from the installation; the fit starts from it.
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
  std::optional<ProjectorPosePrior> position{};  ///< Needed only to fit a surface.
};

struct Measurements {
  calibration::MeasuredLens camera;  ///< Lens with the covariance of its calibration.
  /// Approximate upward tilt of the camera; the solver refines it, and estimates the roll.
  double pitch_rad = 0.0;
  std::vector<TurntableDirection> directions;
  std::vector<MeasuredProjector> projectors;
  /// Approximate distance from the sweet spot to the wall; it sets the scale of all lengths.
  double wall_distance_m = 4.0;
  double wall_distance_sigma_m = 1.0;  ///< Standard deviation: the variation along the wall, and the error.

  /// Checks the values. Errors: kInvalidArgument, with the direction, projector or correspondence at fault and the
  /// remedy.
  [[nodiscard]] Status validate() const;
};

}  // namespace cyclorama::solve
