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

/// What the eye at the sweet spot sees, for many pixels. Borrows the turntable for its life. Reentrant.
class WallDirections {
 public:
  explicit WallDirections(const calibration::CalibratedTurntable& turntable);
  /// Where the camera's pixel looks; a unit vector. Nothing outside of the lens.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(std::size_t direction, const Eigen::Vector2d& camera_px) const;

 private:
  const calibration::CalibratedTurntable& turntable_;
  std::optional<calibration::BrownLens> lens_;
};

/// WallDirections::at() for a single pixel: it finds where the lens folds anew at each call.
[[nodiscard]] std::optional<Eigen::Vector3d> seen_direction(const calibration::CalibratedTurntable& turntable,
                                                            std::size_t direction, const Eigen::Vector2d& camera_px);

/// Solves once without the camera's offset, and then as often as more is known. Borrows what create() was given for its
/// life. Reentrant.
class TurntableSolver {
 public:
  /// Errors as solve_turntable().
  static Result<TurntableSolver> create(const Measurements& measurements, const CellMeans& means,
                                        const TurntableSolverOptions& options);
  /// With an offset if it is clear and predicts tracks that were left out, else without.
  [[nodiscard]] Result<calibration::CalibratedTurntable> solve(const TurntableHints& hints = {}) const;

 private:
  TurntableSolver(const Measurements& measurements, const CellMeans& means, const TurntableSolverOptions& options,
                  ChosenTracks tracks);
  [[nodiscard]] TurntableTask task() const { return {measurements_, means_, options_, tracks_, reference_}; }

  const Measurements& measurements_;
  const CellMeans& means_;
  TurntableSolverOptions options_;
  ChosenTracks tracks_;
  std::size_t reference_;
  SolvedTurntable plain_;
};

/// kInvalidArgument  it cannot be determined; the message says what to add (a direction, an overlap, light).
/// kBadData  the directions contradict one another: the turntable or the projectors moved, or the angles are wrong.
/// Precondition: measurements.validate(). Reentrant.
Result<calibration::CalibratedTurntable> solve_turntable(const Measurements& measurements, const CellMeans& means,
                                                         const TurntableSolverOptions& options = {});

}  // namespace cyclorama::solve
