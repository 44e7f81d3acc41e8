// SPDX-License-Identifier: Apache-2.0
/// The result of a scan: a map per projector, where the camera was, and the wall, if it was asked for.
/// appliance/solve computes it; calibration_file.h writes and reads it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/lens_models.h"
#include "appliance/calibration/measured_lens.h"
#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/surface.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama {

/// How near the wall is in each direction, in 1/m: a sum of the spherical harmonics up to degree two. Exact for a
/// plane; what it lacks of a corner counts, so where a wall was fitted this is what is added to that wall's own.
inline constexpr int kNearnessTerms = 9;
using Nearness = std::array<double, kNearnessTerms>;

/// Where the camera was in each direction, by one bundle adjustment over what several directions saw.
///
/// Gauge: the reference direction's angle is as told, the plate's axis is the Eye frame's y, and the sweet spot is at
/// the camera's height. Whether that axis is plumb is the plate's affair.
struct TurnPlate {
  MeasuredLens camera;  ///< With what the directions taught of it.
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  Eigen::Vector2d offset_m{0.0, 0.0};  ///< Of the camera's centre from the axis: right, forward.
  /// How far off that may be, at the wall's mean nearness; where it is taken for 0, what it may be.
  Eigen::Vector2d offset_sigma_m{0.0, 0.0};
  Nearness nearness{};             ///< Of the wall, 1/m,
  std::optional<Surface> wall{};   ///< to be added to this one's, where one had been fitted.
  std::vector<double> angles_rad;  ///< Of each direction.
  std::size_t reference = 0;       ///< The direction whose angle is as told.

  bool is_offset_estimated = false;
  std::string offset_reason;            ///< Why, or why not.
  std::vector<std::string> parameters;  ///< What the covariance's rows stand for.
  Eigen::MatrixXd covariance;           ///< With the priors.
  int rank = 0;                         ///< Of the measurements alone: parameters that need no prior.
  std::size_t tracks = 0;               ///< Places seen from several directions.
  double rms_px = 0.0;                  ///< Per axis, in projector pixels, of the tracks that were used,
  double heldout_rms_px = 0.0;          ///< and of those that were left out.
};

struct FittedProjector {
  MeasuredLens lens;  ///< With its covariance.
  RigidTransform<frame::Eye, frame::Projector> T_eye_projector;
  Eigen::Matrix<double, 6, 6> pose_covariance = Eigen::Matrix<double, 6, 6>::Zero();  ///< Turn in its frame, place.
};

struct SurfaceFit {
  Surface surface;
  std::vector<double> surface_sigmas;  ///< Of its parameters.
  std::vector<FittedProjector> projectors;
  double cost = 0.0;  ///< Half the sum of robust squares, in sigmas.
  int rank = 0;       ///< Of the measurements alone, of `parameters`.
  int parameters = 0;
};

/// What became of one model.
struct ModelTrial {
  std::string name;
  int parameters = 0;            ///< Of the wall or of one lens.
  double training_rms_px = 0.0;  ///< Told, never used to choose.
  double heldout_rms_px = 0.0;   ///< Over all folds.
  double scatter = 0.0;          ///< Of the wall's distance between folds, relative: how well the model is determined.
  bool is_usable = false;        ///< It fitted, and its folds agree.
};

/// The least model that predicts what it was not shown.
struct ModelChoice {
  SurfaceFit fit;
  LensRung lens = LensRung::kRadial1;
  std::vector<ModelTrial> surfaces;  ///< As far as the ladder was climbed.
  std::vector<ModelTrial> lenses;
  std::string reason;
};

struct CalibratedProjector {
  std::string name;
  MeasuredMap map;
  bool is_previous = false;  ///< The map of before predicted the new measurements better, and stays.
};

struct Calibration {
  std::string date;  ///< "2026-11-22T13-05-00Z": also a folder's name.
  TurnPlate plate;
  std::vector<CalibratedProjector> projectors;
  std::optional<ModelChoice> wall;   ///< Absent where it was not asked for, or could not be found.
  std::vector<std::string> remarks;  ///< For the installer: what is not as it could be, and what to do.
};

}  // namespace cyclorama
