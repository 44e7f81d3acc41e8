// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/calibration.h"
#include "appliance/solve/cell_means.h"
#include "appliance/solve/turntable_problem.h"
#include "common/base/result.h"

namespace cyclorama::solve {

/// What the eye at the sweet spot sees, for many pixels. Borrows the plate for its life. Reentrant.
class WallDirections {
 public:
  explicit WallDirections(const calibration::TurnPlate& plate);
  /// Where the camera's pixel looks; a unit vector. Nothing outside of the lens.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(std::size_t direction, const Eigen::Vector2d& camera_px) const;

 private:
  const calibration::TurnPlate& plate_;
  std::optional<calibration::BrownLens> lens_;
};

/// WallDirections::at() for a single pixel: it finds where the lens folds anew at each call.
[[nodiscard]] std::optional<Eigen::Vector3d> seen_direction(const calibration::TurnPlate& plate, std::size_t direction,
                                                            const Eigen::Vector2d& camera_px);

/// Solves once without the camera's offset, and then as often as more is known. Borrows what create() was given for its
/// life. Reentrant.
class TurnPlateSolver {
 public:
  /// Errors as solve_turn_plate().
  static Result<TurnPlateSolver> create(const Measurements& measurements, const CellMeans& means,
                                        const TurnPlateOptions& options);
  /// With an offset if it is clear and predicts tracks that were left out, else without.
  [[nodiscard]] Result<calibration::TurnPlate> solve(const PlateHints& hints = {}) const;

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
Result<calibration::TurnPlate> solve_turn_plate(const Measurements& measurements, const CellMeans& means,
                                                const TurnPlateOptions& options = {});

}  // namespace cyclorama::solve
