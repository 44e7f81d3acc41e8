// SPDX-License-Identifier: Apache-2.0
#include "appliance/solve/selected_inverse.h"

#include <cstddef>

namespace cyclorama::solve {

std::vector<double> inverse_diagonal(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor) {
  // P A P' = L D L' with a unit diagonal in L. Let Z be the inverse of P A P'. Then Z = D^-1 L^-1 + (1 - L') Z, whose
  // entries below the diagonal need only entries in the factor's pattern.
  const Eigen::SparseMatrix<double> lower = factor.matrixL().nestedExpression();
  const auto& d = factor.vectorD();
  const Eigen::Index n = lower.cols();
  const auto begin = [&](Eigen::Index column) { return lower.outerIndexPtr()[column]; };
  // Entries of Z, in the order of the factor's entries.
  std::vector<double> z(static_cast<std::size_t>(lower.nonZeros()), 0.0);
  std::vector<double> diagonal(static_cast<std::size_t>(n), 0.0);
  std::vector<double> column_of_z(static_cast<std::size_t>(n), 0.0);
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    // Rows of column j with an entry below the diagonal, ascending.
    std::vector<std::pair<std::size_t, double>> entries;
    std::vector<std::size_t> positions;
    for (auto k = begin(j); k < begin(j + 1); ++k) {
      const auto row = static_cast<std::size_t>(lower.innerIndexPtr()[k]);
      if (row <= static_cast<std::size_t>(j)) continue;
      entries.emplace_back(row, lower.valuePtr()[k]);
      positions.push_back(static_cast<std::size_t>(k));
    }
    for (const auto& [row, value] : entries) column_of_z[row] = 0.0;
    // z_ij = -sum_k l_kj z_ik, over the rows k of this column; z is symmetric, so each stored entry is used twice.
    for (std::size_t a = 0; a < entries.size(); ++a) {
      const auto [k, l_kj] = entries[a];
      column_of_z[k] -= l_kj * diagonal[k];
      std::size_t b = a + 1;
      for (auto m = begin(static_cast<Eigen::Index>(k));
           m < begin(static_cast<Eigen::Index>(k) + 1) && b < entries.size(); ++m) {
        const auto row = static_cast<std::size_t>(lower.innerIndexPtr()[m]);
        while (b < entries.size() && entries[b].first < row) ++b;
        if (b == entries.size() || entries[b].first != row) continue;
        const double z_ik = z[static_cast<std::size_t>(m)];
        column_of_z[row] -= l_kj * z_ik;
        column_of_z[k] -= entries[b].second * z_ik;
      }
    }
    double own = 1.0 / d[j];
    for (std::size_t a = 0; a < entries.size(); ++a) {
      const auto [row, value] = entries[a];
      z[positions[a]] = column_of_z[row];
      own -= value * column_of_z[row];
    }
    diagonal[static_cast<std::size_t>(j)] = own;
  }
  std::vector<double> unpermuted(diagonal.size());
  const auto& permutation = factor.permutationP().indices();
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = permutation.size() > 0 ? static_cast<std::size_t>(permutation[i]) : static_cast<std::size_t>(i);
    unpermuted[static_cast<std::size_t>(i)] = diagonal[at];
  }
  return unpermuted;
}

}  // namespace cyclorama::solve
