// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "appliance/solve/robust_loss.h"

namespace cyclorama::solve {

/// A least-squares problem that stands somewhere and can say where it would go. Its numbers are its own affair: some
/// may be eliminated, or live on a sphere.
class DampedProblem {
 public:
  struct Attempt {
    double cost = 0.0;                ///< Where it would come to.
    double predicted_decrease = 0.0;  ///< By the slopes, without damping.
    double relative_change = 0.0;     ///< Length of the step over that of all numbers.
  };
  virtual ~DampedProblem() = default;
  /// What large errors count from now on.
  virtual void weigh_by(RobustLoss loss) = 0;
  /// Half the sum of (robust) squares where it stands; remembers the slopes there. Nothing where a residual has no
  /// value.
  virtual std::optional<double> linearise() = 0;
  /// Where the remembered slopes lead once each number's own curvature counts (1 + damping) times. Nothing where a
  /// residual has no value there, or the equations no solution.
  virtual std::optional<Attempt> attempt(double damping) = 0;
  /// Goes where the last attempt would.
  virtual void accept() = 0;
};

struct DampedOptions {
  int max_steps = 50;
  double function_tolerance = 1e-7;   ///< Relative change of the cost that is none.
  double parameter_tolerance = 1e-8;  ///< Of Attempt::relative_change.
};

/// Goes downhill until nothing changes. Its cost there; nothing when it has none where it begins.
/// The rule for the damping: Nielsen, "Damping Parameter in Marquardt's Method", IMM-REP-1999-05, section 3.
[[nodiscard]] std::optional<double> minimise(DampedProblem* problem, const DampedOptions& options);

/// First with a loss that draws from afar, then, or at once if it does not begin afar, with one that lets gross errors
/// go.
[[nodiscard]] std::optional<double> minimise_robustly(DampedProblem* problem, bool is_from_afar,
                                                      const DampedOptions& options);

/// What a number's own curvature is raised by: its share of damping, and never nothing.
[[nodiscard]] Eigen::VectorXd damping_of(const Eigen::VectorXd& curvatures, double damping);

/// Solves (N + damping diag N) x = -g for a symmetric N of which the lower triangle is read, and writes x.
/// False when that matrix is not positive definite.
bool damped_solution(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double damping,
                     Eigen::VectorXd* ret_step);

}  // namespace cyclorama::solve
