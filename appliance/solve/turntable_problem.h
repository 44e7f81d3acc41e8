// SPDX-License-Identifier: Apache-2.0
/// The bundle adjustment of turntable_solver.cpp: what it moves, what holds it, and what it found.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "appliance/calibration/surface.h"
#include "appliance/solve/tracks.h"
#include "appliance/solve/turntable_cost.h"
#include "common/base/result.h"

namespace cyclorama::solve {

struct TurntableSolverOptions {
  double offset_sigma_m = 0.03;  ///< How far the camera may have been mounted off the axis.
  double mount_sigma_rad = 0.1;
  std::size_t max_tracks = 1500;
  /// Added to where the search begins: pitch, roll, right, forward. Restarts must agree.
  Eigen::Vector4d start = Eigen::Vector4d::Zero();
};

/// What else is known when the turntable is solved again.
struct TurntableHints {
  /// Where a calibration of before has a projector's pixel, turned about as this one is; nothing where it has none.
  std::function<std::optional<KnownDirection>(std::size_t projector, const Eigen::Vector2d& pixel)> known{};
  const calibration::Surface* wall =
      nullptr;  ///< Fitted to a solution of before: it tells inverse_depth better. Borrowed for the call.
};

/// 1/m, never less than a little.
struct InverseDepthField {
  calibration::InverseDepthTerms terms{};
  const calibration::Surface* wall = nullptr;  ///< The terms are added to it. Borrowed.
  [[nodiscard]] double wall_at(const Eigen::Vector3d& direction) const;
  [[nodiscard]] double at(const Eigen::Vector3d& direction) const;
};

/// Where the camera is in one direction of the turntable.
struct CameraPose {
  std::array<double, 2> mount{};   ///< Pitch, roll.
  std::array<double, 2> offset{};  ///< Right, forward.
  double angle_rad = 0.0;
};

/// What the eye at the sweet spot sees of what the camera sees along `ray`; a unit vector.
[[nodiscard]] Eigen::Vector3d wall_direction_along(const CameraPose& pose, const InverseDepthField& inverse_depth,
                                                   const Eigen::Vector3d& ray);

/// What the bundle adjustment moves. Ceres holds pointers into it.
struct TurntableState {
  std::array<double, calibration::MeasuredLens::kParameters> lens{};
  std::array<double, 2> mount{};
  std::array<double, 2> offset{};
  std::vector<double> angles;
  InverseDepthField inverse_depth{};
  std::array<double, 3> turn{};                   ///< Of what is known of before.
  std::vector<std::array<double, 3>> directions;  ///< Of the tracks.

  [[nodiscard]] CameraPose camera(std::size_t direction) const { return {mount, offset, angles[direction]}; }
};

struct TrackError {
  double rms_px = 0.0;
  double rms_sigmas = 0.0;
};

struct SolvedTurntable {
  TurntableState state;
  double cost = 0.0;
  Eigen::MatrixXd covariance;
  int rank = 0;
  std::vector<std::string> names;  ///< Of the covariance's rows.
  std::size_t tracks = 0;
  TrackError used;
  TrackError left_out;

  /// Of the offset, right and forward, in metres at the inverse_depth that was found in the tracks' mean. Only their product
  /// is seen: the scale that the two share, which a prior alone holds, is no part of it. Precondition: with an offset.
  [[nodiscard]] Eigen::Vector2d offset_sigma_m() const;
};

/// What does not change from one solution to the next. Borrows all for its life.
struct TurntableTask {
  const Measurements& measurements;
  const CellMeans& means;
  const TurntableSolverOptions& options;
  const ChosenTracks& tracks;
  std::size_t reference = 0;  ///< The direction whose angle is as told.
};

/// `from` is where the search begins, of a solution without an offset; null: from what was told, and without one.
/// kInvalidArgument  the lens has no directions for the tracks.  kBadData  no start leads anywhere.  Reentrant.
Result<SolvedTurntable> solve_turntable_problem(const TurntableTask& task, const TurntableHints& hints,
                                                const TurntableState* from, const Eigen::Vector2d& offset_m);

/// With the numbers of a state.
[[nodiscard]] calibration::MeasuredLens lens_of(const Measurements& measurements, const TurntableState& state);

}  // namespace cyclorama::solve
