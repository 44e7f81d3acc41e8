// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibrator/solve/cell_means.h"
#include "appliance/calibrator/solve/plate_cost.h"
#include "common/base/result.h"

namespace cyclorama {

/// Where the camera was in each direction, by one bundle adjustment over what several directions saw.
///
/// Gauge: the reference direction's angle is as told, the plate's axis is the Eye frame's y, and the sweet spot is at
/// the camera's height. Whether that axis is plumb is the plate's affair.
struct TurnPlate {
  MeasuredLens camera;  ///< With what the directions taught of it.
  double pitch_rad = 0.0;
  double roll_rad = 0.0;
  Eigen::Vector2d offset_m{0.0, 0.0};  ///< Of the camera's centre from the axis: right, forward.
  Nearness nearness{};                 ///< Of the wall, 1/m.
  std::vector<double> angles_rad;      ///< Of each direction.
  std::size_t reference = 0;           ///< The direction whose angle is as told.

  bool is_offset_estimated = false;
  std::string offset_reason;            ///< Why, or why not.
  std::vector<std::string> parameters;  ///< What the covariance's rows stand for.
  Eigen::MatrixXd covariance;           ///< With the priors.
  int rank = 0;                         ///< Of the measurements alone: parameters that need no prior.
  std::size_t tracks = 0;               ///< Places seen from several directions.
  double rms_px = 0.0;                  ///< Per axis, in projector pixels, of the tracks that were used,
  double heldout_rms_px = 0.0;          ///< and of those that were left out.

  /// What the eye at the sweet spot sees where the camera's pixel looks; a unit vector. Nothing outside of the lens.
  [[nodiscard]] std::optional<Eigen::Vector3d> sight_of(std::size_t direction, const Eigen::Vector2d& camera_px) const;
};

struct TurnPlateOptions {
  double offset_sigma_m = 0.03;  ///< How far the camera may have been mounted off the axis.
  double mount_sigma_rad = 0.1;
  std::size_t most_tracks = 1500;
  /// Added to where the search begins: pitch, roll, right, forward. Restarts must agree.
  Eigen::Vector4d start = Eigen::Vector4d::Zero();
};

/// kInvalidArgument  it cannot be determined; the message says what to add (a direction, an overlap, light).
/// kBadData  the directions contradict one another: the plate or the projectors moved, or the angles are wrong.
/// Precondition: measurements.validate(). Reentrant.
Result<TurnPlate> solve_turn_plate(const Measurements& measurements, const CellMeans& means,
                                   const TurnPlateOptions& options = {});

}  // namespace cyclorama
