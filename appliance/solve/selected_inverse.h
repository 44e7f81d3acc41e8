// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

namespace cyclorama::solve {

/// The diagonal of a sparse positive definite matrix's inverse, from its factors, without the inverse: only the entries
/// where the factor has any are made. Precondition: `factor` succeeded.
/// Source: Takahashi, Fagan and Chin, "Formation of a sparse bus impedance matrix", 1973.
[[nodiscard]] std::vector<double> inverse_diagonal(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor);

}  // namespace cyclorama::solve
