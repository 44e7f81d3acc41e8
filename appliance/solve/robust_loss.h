// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace cyclorama::solve {

/// Loss functions; they differ in the cost of a residual of many sigmas.
enum class RobustLoss {
  kHuber,   ///< Linear in the residual: converges from distant starts.
  kCauchy,  ///< Logarithmic in the residual: ignores outliers.
};

struct WeighedSquare {
  double cost = 0.0;    ///< Half the loss of the squared residual.
  double weight = 1.0;  ///< Derivative of the loss: the weight of the residual in the normal equations.
};

/// Evaluates the loss at `square`, the squared length of a residual in sigmas. Up to `limit` sigmas the cost is about
/// quadratic.
[[nodiscard]] inline WeighedSquare weighed(RobustLoss loss, double limit, double square) {
  const double limits = limit * limit;
  if (loss == RobustLoss::kCauchy) return {0.5 * limits * std::log1p(square / limits), 1.0 / (1.0 + square / limits)};
  if (square <= limits) return {0.5 * square, 1.0};
  const double length = std::sqrt(square);
  return {limit * length - 0.5 * limits, limit / length};
}

}  // namespace cyclorama::solve
