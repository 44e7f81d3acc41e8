// SPDX-License-Identifier: Apache-2.0
/// Poses of projectors and cameras from the cameras' observations: one robust least-squares problem.
///
///   patch      (projector's pixel of the wall point that the camera sees) - (pixel that was shown there)
///   edge       the wall's outline in the camera's picture: locates the cameras in the room
///   prior      the filter's knowledge
///
/// The wall's shape is not estimated. Losses are Cauchy's, and are tightened in three stages so that distant starts
/// converge.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "appliance/healing/estimator/patch_observations.h"
#include "common/base/result.h"

namespace cyclorama::healing {

/// Index of a projector or, after all projectors, of a camera.
using BodyIndex = std::size_t;

struct BodyPrior {
  calibration::PoseMatrix information = calibration::PoseMatrix::Zero();  ///< Information about the believed pose.
  calibration::PoseStep start = calibration::PoseStep::Zero();  ///< Start of the search; not part of the prior.
};

struct BodySolution {
  calibration::PoseStep step = calibration::PoseStep::Zero();
  calibration::PoseMatrix covariance = calibration::PoseMatrix::Zero();  ///< Covariance of the step, prior included.
  /// Information from the measurements alone, marginal over all other bodies.
  calibration::PoseMatrix information = calibration::PoseMatrix::Zero();
  /// Number of directions of `information` that are known to better than a tenth of a loose body's standard deviation.
  int rank = 0;
};

struct PoseSolution {
  std::vector<BodySolution> bodies;  ///< Projectors, then cameras.
  double cost = 0.0;                 ///< Half the sum of the robust losses.
  double noise = 1.0;                ///< Robust standard deviation of the normalised residuals; at least 1.
  std::size_t observations = 0;
};

/// Prior standard deviations of a loose body, whose pose is unknown to the extent of a bump.
inline constexpr double kLooseTurn_rad = 0.2;
inline constexpr double kLooseShift_m = 0.3;
[[nodiscard]] calibration::PoseMatrix loose_information();

/// Solves for the poses of all bodies. Errors: kInvalidArgument if there is no observation; kBadData if the solver does
/// not converge, or gives no finite covariance.
Result<PoseSolution> solve_poses(const calibration::ShowCalibration& room,
                                 std::span<const PatchObservation> observations, std::span<const EdgeObservation> edges,
                                 std::span<const BodyPrior> priors);

/// The bodies that moved: a small set whose displacement explains the observations, found greedily. Empty if no body
/// has to move.
struct MovedBodies {
  std::vector<BodyIndex> bodies;
  PoseSolution solution;
};
/// Finds the bodies that moved, at most `max`. `starts` has a step per body; zero is the believed pose. Errors: those
/// of solve_poses().
Result<MovedBodies> find_moved_bodies(const calibration::ShowCalibration& room,
                                      std::span<const PatchObservation> observations,
                                      std::span<const EdgeObservation> edges, std::span<const BodyPrior> priors,
                                      std::span<const calibration::PoseStep> starts, std::size_t max = 3);

}  // namespace cyclorama::healing
