// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "appliance/calibration/pose_step.h"

namespace cyclorama::healing {

/// Uncertainty of a pose and its update by measurements: a Kalman filter on SE(3) in square-root form.
///
/// The state is the error of the believed pose in the chart of pose_step.h. After each update the chart is centred on
/// the new pose, so the error's mean is always 0 and only the root S of its covariance, P = S S^T, is kept.
///
///   predict   [S sqrt(Q t)] ─ QR ─▶ S             a random walk: lamps warm up
///   update    direction by direction of the measurement's information, by Potter's square-root formula
///
/// P stays positive definite, whatever the measurement's covariance, since no covariance is subtracted. Sources: Potter
/// (1963), in Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977, chapter II. A value;
/// reentrant.
class PoseFilter {
 public:
  /// Standard deviation of the random walk after one second. After a minute it corresponds to 0.06 px at 1080p; the
  /// warm-up of a lamp causes a drift of about 0.1 px in a minute. A larger walk would make the mean less certain. A
  /// settling screw moves faster, and is detected as a bump.
  struct Walk {
    double turn_rad = 5e-6;
    double shift_m = 1e-5;
  };
  PoseFilter(double turn_rad, double shift_m, const Walk& walk);

  void predict(double seconds);

  /// A measured step and its information; directions without information stay unchanged.
  struct Measured {
    calibration::PoseStep step = calibration::PoseStep::Zero();
    calibration::PoseMatrix information = calibration::PoseMatrix::Zero();
  };
  /// Squared length of the innovation in standard deviations, and its number of directions.
  struct Innovation {
    double squared = 0.0;
    int directions = 0;
  };
  [[nodiscard]] Innovation innovation(const Measured& measured) const;
  /// Returns the step to apply to the believed pose.
  calibration::PoseStep update(const Measured& measured);
  /// Returns the squared length of a step from the believed pose, in standard deviations.
  [[nodiscard]] double squared_deviations(const calibration::PoseStep& step) const;
  /// Restarts at a new believed pose with this covariance.
  void restart(const calibration::PoseMatrix& covariance);

  [[nodiscard]] calibration::PoseMatrix covariance() const { return root_ * root_.transpose(); }
  [[nodiscard]] const calibration::PoseMatrix& root() const { return root_; }

 private:
  calibration::PoseMatrix root_ = calibration::PoseMatrix::Zero();
  calibration::PoseStep walk_ = calibration::PoseStep::Zero();
};

/// Returns the squared length that an undisturbed innovation in `directions` directions exceeds as rarely as a normal
/// variable exceeds `normal` standard deviations: for 6, once in about 10^9. Source: Wilson and Hilferty's cube root,
/// Proc. Nat. Acad. Sci. 17, 1931.
[[nodiscard]] double innovation_limit(int directions, double normal = 6.0);

/// The last innovations of one body. Several in a row that are each inconspicuous can be significant together, as after
/// a bump of half a pixel that a filter with a large covariance would follow for seconds. In undisturbed simulated
/// museums their squared lengths were at most 2 for 6 directions; the limit for eight together is 17 per innovation. A
/// value.
class InnovationWindow {
 public:
  static constexpr std::size_t kMaxCount = 8;
  void add(const PoseFilter::Innovation& innovation);
  void forget() { last_.clear(); }
  /// Returns whether the sum of the last two, three, ... or all innovations exceeds innovation_limit().
  [[nodiscard]] bool is_surprising() const;

 private:
  std::deque<PoseFilter::Innovation> last_;  ///< Newest first.
};

/// Removes a prior from a posterior: `step` is the posterior's mean, `prior` the information of a prior with mean 0,
/// and `information` that of the measurement. Returns the measurement alone.
[[nodiscard]] PoseFilter::Measured without_prior(const calibration::PoseStep& step,
                                                 const calibration::PoseMatrix& information,
                                                 const calibration::PoseMatrix& prior);

}  // namespace cyclorama::healing
