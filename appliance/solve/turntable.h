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

/// Maps camera pixels to directions from the sweet spot. Borrows the turntable's calibration for its life. Reentrant.
class WallDirections {
 public:
  explicit WallDirections(const calibration::CalibratedTurntable& turntable);
  /// Returns the unit direction, from the sweet spot, of the wall point that a camera pixel sees; nothing outside the
  /// lens's domain.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(std::size_t direction, const Eigen::Vector2d& camera_px) const;

 private:
  const calibration::CalibratedTurntable& turntable_;
  std::optional<calibration::BrownLens> lens_;
};

/// WallDirections::at() for a single pixel; each call searches again for the fold of the distortion.
[[nodiscard]] std::optional<Eigen::Vector3d> seen_direction(const calibration::CalibratedTurntable& turntable,
                                                            std::size_t direction, const Eigen::Vector2d& camera_px);

/// Solves once without the camera's offset, and then again as more becomes known. Borrows the arguments of create() for
/// its life. Reentrant.
class TurntableSolver {
 public:
  /// Errors: those of solve_turntable().
  static Result<TurntableSolver> create(const Measurements& measurements, const CellMeans& means,
                                        const TurntableSolverOptions& options);
  /// Solves with an offset if that is significant and predicts the left-out tracks better, otherwise without.
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

/// Solves the bundle adjustment of the turntable. Errors: kInvalidArgument if it is underdetermined; the message says
/// what to add (a direction, an overlap, light); kBadData if the directions contradict one another: the turntable or
/// the projectors moved, or the angles are wrong. Precondition: measurements.validate(). Reentrant.
Result<calibration::CalibratedTurntable> solve_turntable(const Measurements& measurements, const CellMeans& means,
                                                         const TurntableSolverOptions& options = {});

}  // namespace cyclorama::solve
