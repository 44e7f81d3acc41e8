// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>

#include <Eigen/Core>
#include <vector>

namespace cyclorama::solve {

struct Uncertainty {
  Eigen::MatrixXd covariance;  ///< Of the first parameters, with all residuals.
  int rank = 0;                ///< Of what `measured` alone tells about them.
};

/// Of a least-squares problem at its solution. `blocks`: first those of which `shared` tangent parameters are asked,
/// then small ones of `small` tangent parameters each that no residual has two of; these are eliminated (Schur).
/// `scale` are the priors' sigmas: what the measurements alone tell better than these counts for the rank. Not by
/// Ceres' Covariance: that takes minutes where thousands of small blocks stand beside few shared ones.
[[nodiscard]] Uncertainty uncertainty_of(ceres::Problem* problem, const std::vector<double*>& blocks, int shared,
                                         int small, const std::vector<double>& scale,
                                         const std::vector<ceres::ResidualBlockId>& measured);

/// The same of normal matrices (lower triangles, not scaled) in which nothing small is left: `all` with all residuals.
[[nodiscard]] Uncertainty uncertainty_of(const Eigen::MatrixXd& all, const Eigen::MatrixXd& measured,
                                         const std::vector<double>& scale);

}  // namespace cyclorama::solve
