// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/map_normal.h"

#include <algorithm>

namespace cyclorama::solve {

std::vector<Bend> bends_of(const calibration::MapGrid& grid) {
  std::vector<Bend> bends;
  for (int y = 0; y <= grid.cells_y; ++y) {
    for (int x = 0; x <= grid.cells_x; ++x) {
      const int at = grid.node(x, y);
      if (x > 0 && x < grid.cells_x) bends.push_back({{at - 1, at, at + 1, 0}, {1.0, -2.0, 1.0, 0.0}, 3});
      const int row = grid.cells_x + 1;
      if (y > 0 && y < grid.cells_y) bends.push_back({{at - row, at, at + row, 0}, {1.0, -2.0, 1.0, 0.0}, 3});
      if (x < grid.cells_x && y < grid.cells_y) {
        bends.push_back({{at, at + 1, at + row, at + row + 1}, {1.0, -1.0, -1.0, 1.0}, 4});
      }
    }
  }
  return bends;
}

MapNormal::MapNormal(const calibration::MapGrid& grid, const std::vector<Bend>& bends)
    : sum_(grid.nodes(), grid.nodes()), right_(Eigen::MatrixX2d::Zero(grid.nodes(), 2)) {
  // The bend across a cell couples all pairs of its corners, so samples add no further entries.
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(8 * bends.size());
  for (const Bend& bend : bends) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(bend.count); ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        entries.emplace_back(std::max(bend.nodes[a], bend.nodes[b]), std::min(bend.nodes[a], bend.nodes[b]), 1.0);
      }
    }
  }
  sum_.setFromTriplets(entries.begin(), entries.end());
  sum_.makeCompressed();
  by_samples_ = Eigen::VectorXd::Zero(sum_.nonZeros());
  by_bends_ = by_samples_;
}

Eigen::Index MapNormal::place_of(int a, int b) const {
  const int row = std::max(a, b);
  Eigen::Index at = sum_.outerIndexPtr()[std::min(a, b)];
  while (sum_.innerIndexPtr()[at] != row) ++at;
  return at;
}

void MapNormal::forget_samples() {
  by_samples_.setZero();
  right_.setZero();
}

void MapNormal::add(const calibration::GridWeights& sample, const Eigen::Vector2d& target, double weight) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double share = weight * sample.factors[a];
    right_.row(sample.nodes[a]) += share * target.transpose();
    for (std::size_t b = 0; b <= a; ++b) {
      by_samples_[place_of(sample.nodes[a], sample.nodes[b])] += share * sample.factors[b];
    }
  }
}

void MapNormal::add(const Bend& bend, double weight) {
  for (std::size_t a = 0; a < static_cast<std::size_t>(bend.count); ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      by_bends_[place_of(bend.nodes[a], bend.nodes[b])] += weight * bend.factors[a] * bend.factors[b];
    }
  }
}

const Eigen::SparseMatrix<double>& MapNormal::at_stiffness(double stiffness) {
  Eigen::Map<Eigen::VectorXd>(sum_.valuePtr(), sum_.nonZeros()) = by_samples_ + by_bends_ / (stiffness * stiffness);
  return sum_;
}

}  // namespace cyclorama::solve
