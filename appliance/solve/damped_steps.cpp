// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/damped_steps.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

constexpr double kFirstDamping = 1e-4;
constexpr double kMinDamping = 1e-16;
constexpr double kMaxDamping = 1e16;  // With more damping no step decreases the cost.
// Function tolerance of the first pass, which only provides a start for the second.
constexpr double kNearEnough = 1e-6;
constexpr double kMinQuality = 1e-3;    // Minimum ratio of actual to predicted decrease.
constexpr double kMinCurvature = 1e-6;  // Lower bound that keeps unconstrained parameters unchanged.

}  // namespace

std::optional<double> minimise(DampedProblem* problem, const DampedOptions& options) {
  auto cost = problem->linearise();
  if (!cost || !std::isfinite(*cost)) return std::nullopt;
  double damping = kFirstDamping;
  double growth = 2.0;
  for (int step = 0; step < options.max_steps && damping < kMaxDamping; ++step) {
    const auto attempt = problem->attempt(damping);
    const double decrease = attempt ? *cost - attempt->cost : -1.0;
    if (attempt && attempt->relative_change <= options.parameter_tolerance) break;
    const bool is_flat = attempt && std::abs(decrease) <= options.function_tolerance * *cost;
    const double quality = attempt ? decrease / attempt->predicted_decrease : -1.0;
    if (!(quality > kMinQuality)) {
      if (is_flat) break;
      damping *= growth;
      growth *= 2.0;
      continue;
    }
    problem->accept();
    if (is_flat) return attempt->cost;
    const double surplus = 2.0 * quality - 1.0;
    damping = std::max(kMinDamping, damping * std::max(1.0 / 3.0, 1.0 - surplus * surplus * surplus));
    growth = 2.0;
    cost = problem->linearise();
    if (!cost) return std::nullopt;
  }
  return cost;
}

std::optional<double> minimise_robustly(DampedProblem* problem, bool is_from_afar, const DampedOptions& options) {
  if (is_from_afar) {
    problem->weigh_by(RobustLoss::kHuber);
    DampedOptions coarse = options;
    coarse.function_tolerance = std::max(coarse.function_tolerance, kNearEnough);
    if (!minimise(problem, coarse)) return std::nullopt;
  }
  problem->weigh_by(RobustLoss::kCauchy);
  return minimise(problem, options);
}

Eigen::VectorXd damping_of(const Eigen::VectorXd& curvatures, double damping) {
  return damping * curvatures.cwiseMax(kMinCurvature);
}

bool damped_solution(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient, double damping,
                     Eigen::VectorXd* ret_step) {
  Eigen::MatrixXd damped = normal.triangularView<Eigen::Lower>();
  damped.diagonal() += damping_of(normal.diagonal(), damping);
  const Eigen::LLT<Eigen::MatrixXd> factor(damped);
  if (factor.info() != Eigen::Success) return false;
  *ret_step = factor.solve(-gradient);
  return ret_step->allFinite();
}

}  // namespace cyclorama::solve
