// SPDX-License-Identifier: Apache-2.0
/// The result of a scan: a map per projector, the camera's poses, and the wall if it was requested. appliance/solve
/// computes it; calibration_file.h writes and reads it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/lens_model.h"
#include "appliance/calibration/measured_lens.h"
#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/surface.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama::calibration {

/// Inverse distance of the wall per direction, in 1/m, as a sum of the spherical harmonics up to degree two. The sum is
/// exact for a plane but not for a corner, so if a wall was fitted, the sum is a correction to the inverse distance of
/// that wall.
inline constexpr int kInverseDepthTerms = 9;
using InverseDepthTerms = std::array<double, kInverseDepthTerms>;

/// The camera's pose in each direction, from one bundle adjustment over the points that were seen in several
/// directions.
///
/// Gauge: the reference direction has the angle that the turntable reported, the turntable's axis is the Eye frame's y,
/// and the sweet spot is at the camera's height. The axis is as vertical as the turntable was set up.
struct CalibratedTurntable {
  MeasuredLens camera;  ///< Refined by the bundle adjustment.
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  Eigen::Vector2d offset_m{0.0, 0.0};  ///< Offset from the turntable's axis to the camera's centre: right, forward.
  /// Standard deviation of the offset, at the wall's mean inverse distance; if the offset is taken to be 0, the
  /// deviation includes the offset that was found.
  Eigen::Vector2d offset_sigma_m{0.0, 0.0};
  InverseDepthTerms inverse_depth{};  ///< Inverse distance of the wall, added to that of `wall` if there is one.
  std::optional<Surface> wall{};      ///< The wall, if it had been fitted before.
  std::vector<double> angles_rad;     ///< One per direction.
  std::size_t reference = 0;          ///< Index of the direction that keeps its reported angle.

  bool is_offset_estimated = false;
  std::string offset_reason;            ///< Reason why the offset was or was not estimated, for the installer.
  std::vector<std::string> parameters;  ///< Names of the covariance's rows.
  Eigen::MatrixXd covariance;           ///< Covariance of `parameters`, including priors.
  int rank = 0;                         ///< Number of parameters that the measurements alone determine.
  std::size_t tracks = 0;               ///< Number of points that were seen from several directions.
  double rms_px = 0.0;  ///< Root mean square error per axis, in projector pixels, over the tracks that were used.
  double heldout_rms_px = 0.0;  ///< Same over the tracks that were left out of the fit.
};

struct FittedProjector {
  MeasuredLens lens;  ///< With its covariance.
  RigidTransform<frame::Eye, frame::Projector> T_eye_projector;
  Eigen::Matrix<double, 6, 6> pose_covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< Rotation in the projector's frame, then translation.
};

struct SurfaceFit {
  Surface surface;
  std::vector<double> surface_sigmas;  ///< One per parameter of the surface.
  std::vector<FittedProjector> projectors;
  double cost = 0.0;  ///< Half the sum of the robust squared errors, in sigmas.
  int rank = 0;       ///< Number of `parameters` that the measurements alone determine.
  int parameters = 0;
};

/// The result of one candidate model.
struct ModelTrial {
  std::string name;
  int parameters = 0;            ///< Number of parameters of the wall, or of one lens.
  double training_rms_px = 0.0;  ///< For information; never used for the selection.
  double heldout_rms_px = 0.0;   ///< Root mean square error over all folds, for left-out measurements.
  double scatter = 0.0;          ///< Relative spread of the wall's distance between folds.
  bool is_usable = false;        ///< The model could be fitted, and its folds agree.
};

/// The smallest model that predicts the left-out measurements.
struct ModelChoice {
  SurfaceFit fit;
  LensModel lens = LensModel::kRadial1;
  std::vector<ModelTrial> surfaces;  ///< Candidates in the order in which they were tried.
  std::vector<ModelTrial> lenses;
  std::string reason;
};

struct CalibratedProjector {
  std::string name;
  MeasuredMap map;
  bool is_previous = false;  ///< True: the previous map was kept, since it predicted the new measurements better.
};

struct Calibration {
  std::string date;  ///< Such as "2026-11-22T13-05-00Z"; also the name of a folder.
  CalibratedTurntable turntable;
  std::vector<CalibratedProjector> projectors;
  std::optional<ModelChoice> wall;   ///< Absent if no wall was requested, or none could be found.
  std::vector<std::string> remarks;  ///< Shortcomings with their remedies, for the installer.
};

}  // namespace cyclorama::calibration
