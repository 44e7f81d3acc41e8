// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "appliance/calibration/pose_step.h"

namespace cyclorama::healing {

/// How sure a pose is, and what a measurement changes: a Kalman filter on SE(3) in square-root form.
///
/// The state is the error of the believed pose in the chart of pose_step.h; after each update the chart is put about
/// the new pose, so the error's mean is always 0 and only the root S of its covariance, P = S S^T, is kept.
///
///   predict   [S sqrt(Q t)] ─ QR ─▶ S             a random walk: lamps warm up, screws settle
///   update    direction by direction of the measurement's information, by Potter's square-root formula
///
/// P stays positive however unequal P and R are: it is never formed to be subtracted from.
/// Sources: Potter (1963), in Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977, chapter II.
/// A value; reentrant.
class PoseFilter {
 public:
  /// Per square root of a second: 0.06 px of 1080p in a minute, in which warm-up drifts by 0.1 px or so; twice as
  /// much makes the mean less sure by half. A screw settles quicker, and is found as a bump.
  struct Walk {
    double turn_rad = 5e-6;
    double shift_m = 1e-5;
  };
  PoseFilter(double turn_rad, double shift_m, const Walk& walk);

  void predict(double seconds);

  /// A measured step and its information; directions without any are left alone.
  struct Measured {
    calibration::PoseStep step = calibration::PoseStep::Zero();
    calibration::PoseMatrix information = calibration::PoseMatrix::Zero();
  };
  /// The innovation's squared length in deviations, and of how many directions it is.
  struct Innovation {
    double squared = 0.0;
    int directions = 0;
  };
  [[nodiscard]] Innovation innovation(const Measured& measured) const;
  /// What the believed pose is to be stepped by.
  calibration::PoseStep update(const Measured& measured);
  /// How many deviations, squared, a step away from the believed pose is.
  [[nodiscard]] double squared_deviations(const calibration::PoseStep& step) const;
  /// The pose is a new one, known so well.
  void restart(const calibration::PoseMatrix& covariance);

  [[nodiscard]] calibration::PoseMatrix covariance() const { return root_ * root_.transpose(); }
  [[nodiscard]] const calibration::PoseMatrix& root() const { return root_; }

 private:
  calibration::PoseMatrix root_ = calibration::PoseMatrix::Zero();
  calibration::PoseStep walk_ = calibration::PoseStep::Zero();
};

/// The squared length, in deviations, that as few undisturbed ones of so many directions exceed as a normal variable
/// exceeds `normal`: beyond 6 lies one in about 10^9. Wilson and Hilferty's cube root, Proc. Nat. Acad. Sci. 17, 1931.
[[nodiscard]] double innovation_limit(int directions, double normal = 6.0);

/// The last innovations of one body: several in a row that are each no wonder are one together, as after a bump of half
/// a pixel that a filter, not yet sure, would follow for seconds. Undisturbed, in simulated museums, they were 2 of 6
/// directions at most; the limit for eight together is 17 each. A value.
class InnovationWindow {
 public:
  static constexpr std::size_t kMaxCount = 8;
  void add(const PoseFilter::Innovation& innovation);
  void forget() { last_.clear(); }
  /// Whether the last two, or three, ... or all exceed what one in 10^9 would.
  [[nodiscard]] bool is_surprising() const;

 private:
  std::deque<PoseFilter::Innovation> last_;  ///< Newest first.
};

/// What a posterior that had a prior of `prior` about 0 says that was measured: the step and its information alone.
[[nodiscard]] PoseFilter::Measured without_prior(const calibration::PoseStep& step,
                                                 const calibration::PoseMatrix& information,
                                                 const calibration::PoseMatrix& prior);

}  // namespace cyclorama::healing
