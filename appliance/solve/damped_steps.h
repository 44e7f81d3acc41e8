// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "appliance/solve/robust_loss.h"

namespace cyclorama::solve {

/// Interface of a least-squares problem with a current state, which computes steps. The parametrisation is hidden, so a
/// problem may eliminate parameters or represent them on a sphere.
class DampedProblem {
 public:
  struct Attempt {
    double cost = 0.0;                ///< Cost at the proposed state.
    double predicted_decrease = 0.0;  ///< From the linearisation, without damping.
    double relative_change = 0.0;     ///< Length of the step relative to that of all parameters.
  };
  virtual ~DampedProblem() = default;
  /// Sets the robust loss for subsequent calls.
  virtual void weigh_by(RobustLoss loss) = 0;
  /// Returns half the sum of (robust) squares at the current state, and stores the linearisation. Returns nothing if a
  /// residual has no value.
  virtual std::optional<double> linearise() = 0;
  /// Computes the step of the stored linearisation with each diagonal entry of the normal matrix multiplied by (1 +
  /// damping). Returns nothing if a residual has no value at the proposed state or the equations have no solution.
  virtual std::optional<Attempt> attempt(double damping) = 0;
  /// Moves to the state that the last attempt proposed.
  virtual void accept() = 0;
};

struct DampedOptions {
  int max_steps = 50;
  double function_tolerance = 1e-7;   ///< Relative change of the cost that counts as convergence.
  double parameter_tolerance = 1e-8;  ///< Attempt::relative_change that counts as convergence.
};

/// Minimises until convergence (Levenberg-Marquardt) or `max_steps`, and returns the final cost; nothing if the initial
/// state has no cost. Damping rule: Nielsen, "Damping Parameter in Marquardt's Method", IMM-REP-1999-05, section 3.
[[nodiscard]] std::optional<double> minimise(DampedProblem* problem, const DampedOptions& options);

/// Minimises first with the Huber loss, which converges from distant starts, then with the Cauchy loss, which ignores
/// outliers. Skips the first pass unless `is_from_afar`.
[[nodiscard]] std::optional<double> minimise_robustly(DampedProblem* problem, bool is_from_afar,
                                                      const DampedOptions& options);

/// Returns the amounts to add to the diagonal of the normal matrix: `damping` times each entry, with a positive lower
/// bound.
[[nodiscard]] Eigen::VectorXd damping_of(const Eigen::VectorXd& curvatures, double damping);

/// Solves (N + damping diag N) x = -g for a symmetric N, of which only the lower triangle is read, and writes x.
/// Returns false if the matrix is not positive definite.
bool damped_solution(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double damping,
                     Eigen::VectorXd* ret_step);

}  // namespace cyclorama::solve
