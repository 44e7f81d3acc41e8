// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

namespace cyclorama::solve {

/// Returns the diagonal of the inverse of a sparse positive definite matrix from the matrix's factors. Only the
/// inverse's entries in the factor's sparsity pattern are computed. Precondition: `factor` succeeded. Source:
/// Takahashi, Fagan and Chin, "Formation of a sparse bus impedance matrix", 1973.
[[nodiscard]] std::vector<double> inverse_diagonal(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor);

}  // namespace cyclorama::solve
