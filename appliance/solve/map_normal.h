// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "appliance/calibration/map_grid.h"

namespace cyclorama::solve {

/// One bend that smoothness keeps small: the weighted sum of up to four control points.
struct Bend {
  std::array<int, 4> nodes{};
  std::array<double, 4> factors{};
  int count = 0;
};

/// Along rows, along columns, and across each cell.
[[nodiscard]] std::vector<Bend> bends_of(const calibration::MapGrid& grid);

/// The normal equations of a map's control points: what samples say, and what bends say over the square of a stiffness.
/// The two are summed apart, so that another stiffness costs no new sums; which entries there are never changes.
/// Thread-bound.
class MapNormal {
 public:
  MapNormal(const calibration::MapGrid& grid, const std::vector<Bend>& bends);

  void forget_samples();
  void forget_bends() { by_bends_.setZero(); }
  /// That the weighted sum of a sample's nodes is `target`.
  void add(const calibration::GridWeights& sample, const Eigen::Vector2d& target, double weight);
  /// That a bend is 0, at stiffness 1.
  void add(const Bend& bend, double weight);
  /// Its lower triangle.
  [[nodiscard]] const Eigen::SparseMatrix<double>& at_stiffness(double stiffness);
  [[nodiscard]] const Eigen::MatrixX2d& right() const { return right_; }

 private:
  [[nodiscard]] Eigen::Index place_of(int a, int b) const;

  Eigen::SparseMatrix<double> sum_;
  Eigen::VectorXd by_samples_;  ///< Of each of its entries.
  Eigen::VectorXd by_bends_;
  Eigen::MatrixX2d right_;
};

}  // namespace cyclorama::solve
