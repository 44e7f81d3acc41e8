// SPDX-License-Identifier: Apache-2.0
/// Where projectors and cameras stand, from what the cameras saw: one robust least-squares problem.
///
///   patch_observation   (projector's pixel of the wall point that the camera looks at) - (pixel that was shown there)
///   edge       the wall's outline, where the camera sees it: the cameras' hold on the room
///   prior      what the filter knew
///
/// The wall is as calibrated. Losses are Cauchy's; far starts are reached by tightening them in three stages.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "appliance/healing/estimator/patch_observations.h"
#include "common/base/result.h"

namespace cyclorama::healing {

/// A projector, or (counted on after the projectors) a camera.
using BodyIndex = std::size_t;

struct BodyPrior {
  calibration::PoseMatrix information = calibration::PoseMatrix::Zero();  ///< About the believed pose.
  calibration::PoseStep start = calibration::PoseStep::Zero();  ///< Where the search begins; not part of what is known.
};

struct BodySolution {
  calibration::PoseStep step = calibration::PoseStep::Zero();
  calibration::PoseMatrix covariance = calibration::PoseMatrix::Zero();  ///< Of the step, prior included.
  calibration::PoseMatrix information =
      calibration::PoseMatrix::Zero();  ///< What the measurements alone tell, all other bodies being uncertain.
  int rank = 0;                         ///< Of that: directions known better than a tenth of the prior's start.
};

struct PoseSolution {
  std::vector<BodySolution> bodies;  ///< Projectors, then cameras.
  double cost = 0.0;                 ///< Robust, half the sum.
  double noise = 1.0;                ///< Residuals' robust deviation in units of what was promised; at least 1.
  std::size_t observations = 0;
};

/// Pose of nobody that is loose: what a bump may do.
inline constexpr double kLooseTurn_rad = 0.2;
inline constexpr double kLooseShift_m = 0.3;
[[nodiscard]] calibration::PoseMatrix loose_information();

/// kInvalidArgument  nothing was seen.   kBadData  it did not converge, or told no finite covariance.
Result<PoseSolution> solve_poses(const calibration::ShowCalibration& room,
                                 std::span<const PatchObservation> observations, std::span<const EdgeObservation> edges,
                                 std::span<const BodyPrior> priors);

/// Which bodies moved: the least set whose freedom explains what was seen, found greedily. Empty: none has to.
struct MovedBodies {
  std::vector<BodyIndex> bodies;
  PoseSolution solution;
};
/// `starts` per body, zero where there is none. At most `most` bodies. Errors of solve_poses().
Result<MovedBodies> find_moved_bodies(const calibration::ShowCalibration& room,
                                      std::span<const PatchObservation> observations,
                                      std::span<const EdgeObservation> edges, std::span<const BodyPrior> priors,
                                      std::span<const calibration::PoseStep> starts, std::size_t max = 3);

}  // namespace cyclorama::healing
