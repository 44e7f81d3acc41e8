// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "appliance/calibration/map_grid.h"

namespace cyclorama::solve {

/// Smoothness term: a weighted sum of up to four control points whose expected value is 0.
struct Bend {
  std::array<int, 4> nodes{};
  std::array<double, 4> factors{};
  int count = 0;
};

/// Returns the bends along rows, along columns and across each cell.
[[nodiscard]] std::vector<Bend> bends_of(const calibration::MapGrid& grid);

/// Normal equations of a map's control points: the terms of the samples plus those of the bends divided by the square
/// of a stiffness. The two are summed separately, so that a new stiffness needs no new summation; the sparsity pattern
/// never changes. Thread-bound.
class MapNormal {
 public:
  MapNormal(const calibration::MapGrid& grid, const std::vector<Bend>& bends);

  void forget_samples();
  void forget_bends() { by_bends_.setZero(); }
  /// Adds the equation that the weighted sum of a sample's nodes equals `target`.
  void add(const calibration::GridWeights& sample, const Eigen::Vector2d& target, double weight);
  /// Adds the equation that a bend is 0, at stiffness 1.
  void add(const Bend& bend, double weight);
  /// Returns the lower triangle of the normal matrix for a stiffness.
  [[nodiscard]] const Eigen::SparseMatrix<double>& at_stiffness(double stiffness);
  [[nodiscard]] const Eigen::MatrixX2d& right() const { return right_; }

 private:
  [[nodiscard]] Eigen::Index place_of(int a, int b) const;

  Eigen::SparseMatrix<double> sum_;
  Eigen::VectorXd by_samples_;  ///< One value per stored entry of `sum_`.
  Eigen::VectorXd by_bends_;
  Eigen::MatrixX2d right_;
};

}  // namespace cyclorama::solve
