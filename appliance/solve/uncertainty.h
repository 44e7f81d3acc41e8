// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <vector>

namespace cyclorama::solve {

struct Uncertainty {
  Eigen::MatrixXd covariance;  ///< Covariance of the first parameters, from all residuals.
  int rank = 0;                ///< Number of parameters that `measured` alone determines.
};

/// Computes the uncertainty of a least-squares problem at its solution. `blocks` lists first the blocks whose `shared`
/// tangent parameters are reported, then blocks of `small` tangent parameters each, which are eliminated (Schur
/// complement); no residual may depend on two small blocks. `scale` holds the priors' sigmas: a parameter counts for
/// the rank if the measurements alone determine it better than its sigma. Ceres' Covariance would take minutes for
/// thousands of small blocks.
[[nodiscard]] Uncertainty uncertainty_of(ceres::Problem* problem, const std::vector<double*>& blocks, int shared,
                                         int small, const std::vector<double>& scale,
                                         const std::vector<ceres::ResidualBlockId>& measured);

/// Computes the uncertainty from normal matrices (lower triangles, unscaled) without small blocks: `all` is from all
/// residuals, `measured` from the measurements alone.
[[nodiscard]] Uncertainty uncertainty_of(const Eigen::MatrixXd& all, const Eigen::MatrixXd& measured,
                                         const std::vector<double>& scale);

}  // namespace cyclorama::solve
