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

/// Maps camera pixels to directions from the sweet spot. Borrows the turntable's calibration. Reentrant.
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

/// Returns WallDirections::at() for a single pixel. Slower, since each call searches for the limit of the distortion
/// again.
[[nodiscard]] std::optional<Eigen::Vector3d> seen_direction(const calibration::CalibratedTurntable& turntable,
                                                            std::size_t direction, const Eigen::Vector2d& camera_px);

/// Solves the turntable without the camera's offset once, in create(), and again in each solve(), as more becomes
/// known. Borrows the arguments of create(). Reentrant.
class TurntableSolver {
 public:
  /// Chooses the tracks, and solves without an offset. Errors: those of solve_turntable().
  static Result<TurntableSolver> create(const Measurements& measurements, const CellMeans& means,
                                        const TurntableSolverOptions& options);
  /// Solves with an offset if the offset is significant and improves the prediction of left-out tracks, otherwise
  /// without.
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

/// Solves the bundle adjustment of the turntable. Errors: kInvalidArgument if it is underdetermined; the message gives
/// the remedy (a direction, an overlap, light); kBadData if the directions contradict each other, because the turntable
/// or the projectors moved or the angles are wrong. Precondition: measurements.validate(). Reentrant.
Result<calibration::CalibratedTurntable> solve_turntable(const Measurements& measurements, const CellMeans& means,
                                                         const TurntableSolverOptions& options = {});

}  // namespace cyclorama::solve
