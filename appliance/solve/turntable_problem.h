// SPDX-License-Identifier: Apache-2.0
/// The bundle adjustment of turntable.cpp: its parameters, priors and results.
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
  double offset_sigma_m = 0.03;  ///< Prior standard deviation of the camera's offset from the axis.
  double mount_sigma_rad = 0.1;
  std::size_t max_tracks = 1500;
  /// Added to the initial pitch, roll, right and forward, so that tests can start from different values.
  Eigen::Vector4d start = Eigen::Vector4d::Zero();
};

/// Additional information for a further solution of the turntable.
struct TurntableHints {
  /// Returns the direction of a projector's pixel in an earlier calibration; nothing if there is none. The rotation
  /// between the two calibrations is estimated.
  std::function<std::optional<KnownDirection>(std::size_t projector, const Eigen::Vector2d& pixel)> known{};
  const calibration::Surface* wall = nullptr;  ///< Wall fitted to an earlier solution; may be null. Borrowed.
};

/// Inverse distance of the wall in 1/m, with a small positive lower bound.
struct InverseDepthField {
  calibration::InverseDepthTerms terms{};
  const calibration::Surface* wall = nullptr;  ///< May be null; `terms` is added to its inverse depth. Borrowed.
  [[nodiscard]] double wall_at(const Eigen::Vector3d& direction) const;
  [[nodiscard]] double at(const Eigen::Vector3d& direction) const;
};

/// Pose of the camera in one direction of the turntable.
struct CameraPose {
  std::array<double, 2> mount{};   ///< Pitch, roll.
  std::array<double, 2> offset{};  ///< Right, forward.
  double angle_rad = 0.0;
};

/// Returns the unit direction from the sweet spot to the wall point that the camera sees along `ray`.
[[nodiscard]] Eigen::Vector3d wall_direction_along(const CameraPose& pose, const InverseDepthField& inverse_depth,
                                                   const Eigen::Vector3d& ray);

/// Parameters of the bundle adjustment.
struct TurntableState {
  std::array<double, calibration::MeasuredLens::kParameters> lens{};
  std::array<double, 2> mount{};
  std::array<double, 2> offset{};
  std::vector<double> angles;
  InverseDepthField inverse_depth{};
  std::array<double, 3> turn{};                   ///< Rotation from an earlier calibration to this one.
  std::vector<std::array<double, 3>> directions;  ///< One per track.

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
  std::vector<std::string> names;  ///< Names of the covariance's rows.
  std::size_t tracks = 0;
  TrackError used;
  TrackError left_out;

  /// Standard deviation of the offset, right and forward, in metres at the mean inverse depth of the tracks. Only the
  /// product of offset and inverse depth is observable, so the uncertainty of their common scale is excluded.
  /// Precondition: solved with an offset.
  [[nodiscard]] Eigen::Vector2d offset_sigma_m() const;
};

/// Inputs that all solutions share. Borrows its members.
struct TurntableTask {
  const Measurements& measurements;
  const CellMeans& means;
  const TurntableSolverOptions& options;
  const ChosenTracks& tracks;
  std::size_t reference = 0;  ///< The direction that keeps its reported angle.
};

/// Solves the bundle adjustment. `from` is the initial state, a solution without an offset; if null, the solution
/// starts at the reported values and has no offset. Errors: kInvalidArgument if the lens has no directions for the
/// tracks; kBadData if no start converges. Reentrant.
Result<SolvedTurntable> solve_turntable_problem(const TurntableTask& task, const TurntableHints& hints, const TurntableState* from,
                                    const Eigen::Vector2d& offset_m);

/// Returns the camera's lens with the parameters of a state.
[[nodiscard]] calibration::MeasuredLens lens_of(const Measurements& measurements, const TurntableState& state);

}  // namespace cyclorama::solve
