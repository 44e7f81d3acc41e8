// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/uncertainty.h"

#include <ceres/crs_matrix.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace cyclorama::solve {
namespace {

/// Returns the scaled normal matrix of the shared parameters after the small blocks are eliminated.
Eigen::MatrixXd reduced_normal(ceres::Problem* problem, const std::vector<double*>& blocks, int shared, int small,
                               const std::vector<double>& scale, const std::vector<ceres::ResidualBlockId>* residuals) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  if (residuals != nullptr) options.residual_blocks = *residuals;
  ceres::CRSMatrix jacobian;
  problem->Evaluate(options, nullptr, nullptr, nullptr, &jacobian);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(shared, shared);
  const int count = small > 0 ? (jacobian.num_cols - shared) / small : 0;
  std::vector<Eigen::MatrixXd> own(static_cast<std::size_t>(count), Eigen::MatrixXd::Zero(small, small));
  std::vector<Eigen::MatrixXd> cross(static_cast<std::size_t>(count), Eigen::MatrixXd::Zero(small, shared));
  Eigen::VectorXd row(shared);
  Eigen::VectorXd part(std::max(small, 1));
  for (int r = 0; r < jacobian.num_rows; ++r) {
    row.setZero();
    part.setZero();
    int block = -1;
    for (int k = jacobian.rows[static_cast<std::size_t>(r)]; k < jacobian.rows[static_cast<std::size_t>(r) + 1]; ++k) {
      const int column = jacobian.cols[static_cast<std::size_t>(k)];
      const double value = jacobian.values[static_cast<std::size_t>(k)];
      if (column < shared) {
        row[column] = value * scale[static_cast<std::size_t>(column)];
      } else {
        block = (column - shared) / small;
        part[(column - shared) % small] = value;
      }
    }
    normal.noalias() += row * row.transpose();
    if (block < 0) continue;
    own[static_cast<std::size_t>(block)].noalias() += part * part.transpose();
    cross[static_cast<std::size_t>(block)].noalias() += part * row.transpose();
  }
  for (std::size_t b = 0; b < own.size(); ++b) {
    const Eigen::LDLT<Eigen::MatrixXd> factor(own[b]);
    if (factor.info() != Eigen::Success || !(own[b].diagonal().minCoeff() > 0.0)) continue;
    normal.noalias() -= cross[b].transpose() * factor.solve(cross[b]);
  }
  return normal;
}

/// Computes the uncertainty from scaled normal matrices.
Uncertainty uncertainty_of_scaled(const Eigen::MatrixXd& all, const Eigen::MatrixXd& measured,
                                  const std::vector<double>& scale) {
  Uncertainty uncertainty;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(all);
  const Eigen::Map<const Eigen::VectorXd> scales(scale.data(), all.rows());
  // An unconstrained direction gets a finite uncertainty of a million times its scale.
  const Eigen::VectorXd variances = eigen.eigenvalues().cwiseMax(1e-12).cwiseInverse();
  uncertainty.covariance = scales.asDiagonal() * eigen.eigenvectors() * variances.asDiagonal() *
                           eigen.eigenvectors().transpose() * scales.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> alone(measured, Eigen::EigenvaluesOnly);
  // An eigenvalue above 1 means that the measurements alone determine the direction at least as well as the prior.
  uncertainty.rank = static_cast<int>((alone.eigenvalues().array() > 1.0).count());
  return uncertainty;
}

}  // namespace

Uncertainty uncertainty_of(ceres::Problem* problem, const std::vector<double*>& blocks, int shared, int small,
                           const std::vector<double>& scale, const std::vector<ceres::ResidualBlockId>& measured) {
  return uncertainty_of_scaled(reduced_normal(problem, blocks, shared, small, scale, nullptr),
                               reduced_normal(problem, blocks, shared, small, scale, &measured), scale);
}

Uncertainty uncertainty_of(const Eigen::MatrixXd& all, const Eigen::MatrixXd& measured,
                           const std::vector<double>& scale) {
  const Eigen::Map<const Eigen::VectorXd> scales(scale.data(), all.rows());
  // An eigensolver reads only the lower triangle.
  const auto scaled = [&](const Eigen::MatrixXd& normal) -> Eigen::MatrixXd {
    return scales.asDiagonal() * normal * scales.asDiagonal();
  };
  return uncertainty_of_scaled(scaled(all), scaled(measured), scale);
}

}  // namespace cyclorama::solve
