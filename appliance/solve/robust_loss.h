// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace cyclorama::solve {

/// How much an error counts that is many sigmas large.
enum class RobustLoss {
  kHuber,   ///< In proportion: draws from afar.
  kCauchy,  ///< Ever less: lets gross errors go.
};

struct WeighedSquare {
  double cost = 0.0;    ///< Half of what the loss makes of the square.
  double weight = 1.0;  ///< What the square counts in the normal equations: the loss's slope.
};

/// Of the squared length of a residual, both in sigmas; errors of up to `limit` count as squares, about.
[[nodiscard]] inline WeighedSquare weighed(RobustLoss loss, double limit, double square) {
  const double limits = limit * limit;
  if (loss == RobustLoss::kCauchy) return {0.5 * limits * std::log1p(square / limits), 1.0 / (1.0 + square / limits)};
  if (square <= limits) return {0.5 * square, 1.0};
  const double length = std::sqrt(square);
  return {limit * length - 0.5 * limits, limit / length};
}

}  // namespace cyclorama::solve
