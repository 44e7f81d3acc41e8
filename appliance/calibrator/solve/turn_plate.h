// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibrator/solve/cell_means.h"
#include "appliance/calibrator/solve/plate_problem.h"
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

  /// As PlateSights::at(), but finds the lens's fold anew at each call.
  [[nodiscard]] std::optional<Eigen::Vector3d> sight_of(std::size_t direction, const Eigen::Vector2d& camera_px) const;
};

/// What the eye at the sweet spot sees, for many pixels. Borrows the plate for its life. Reentrant.
class PlateSights {
 public:
  explicit PlateSights(const TurnPlate& plate);
  /// Where the camera's pixel looks; a unit vector. Nothing outside of the lens.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(std::size_t direction, const Eigen::Vector2d& camera_px) const;

 private:
  const TurnPlate& plate_;
  std::optional<BrownLens> lens_;
};

/// Solves once without the camera's offset, and then as often as more is known. Borrows what create() was given for its
/// life. Reentrant.
class TurnPlateSolver {
 public:
  /// Errors as solve_turn_plate().
  static Result<TurnPlateSolver> create(const Measurements& measurements, const CellMeans& means,
                                        const TurnPlateOptions& options);
  /// With an offset if it is clear and predicts tracks that were left out, else without.
  [[nodiscard]] Result<TurnPlate> solve(const PlateHints& hints = {}) const;

 private:
  TurnPlateSolver(const Measurements& measurements, const CellMeans& means, const TurnPlateOptions& options,
                  ChosenTracks tracks);
  [[nodiscard]] PlateTask task() const { return {measurements_, means_, options_, tracks_, reference_}; }

  const Measurements& measurements_;
  const CellMeans& means_;
  TurnPlateOptions options_;
  ChosenTracks tracks_;
  std::size_t reference_;
  SolvedPlate plain_;
};

/// kInvalidArgument  it cannot be determined; the message says what to add (a direction, an overlap, light).
/// kBadData  the directions contradict one another: the plate or the projectors moved, or the angles are wrong.
/// Precondition: measurements.validate(). Reentrant.
Result<TurnPlate> solve_turn_plate(const Measurements& measurements, const CellMeans& means,
                                   const TurnPlateOptions& options = {});

}  // namespace cyclorama
