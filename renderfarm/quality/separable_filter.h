// SPDX-License-Identifier: Apache-2.0
/// Filters whose kernel is a column times a row: the cost grows with the radius, not with its square. Reentrant.
#pragma once

#include <vector>

#include "common/image/image.h"

namespace cyclorama {

/// A kernel has an odd number of weights; the middle one is the pixel's own.
using Kernel = std::vector<double>;

/// exp(-x² / (2σ²)) for x in [-radius, radius]. Preconditions: `radius` >= 0, `sigma_px` > 0.
[[nodiscard]] Kernel gaussian(int radius, double sigma_px);

[[nodiscard]] double sum_of(const Kernel& kernel);
/// Its sum becomes 1. Precondition: the sum is not 0.
[[nodiscard]] Kernel normalized(Kernel kernel);

/// Each pixel becomes the weighted sum of its surroundings (a correlation: the first weights are for the left and the
/// upper pixels). Beyond the border the outermost pixels go on.
template <typename T>
[[nodiscard]] Image<T, 1> filtered_along_rows(const Image<T, 1>& plane, const Kernel& kernel);
template <typename T>
[[nodiscard]] Image<T, 1> filtered_along_columns(const Image<T, 1>& plane, const Kernel& kernel);

template <typename T>
[[nodiscard]] Image<T, 1> filtered(const Image<T, 1>& plane, const Kernel& along_rows, const Kernel& along_columns) {
  return filtered_along_columns(filtered_along_rows(plane, along_rows), along_columns);
}

extern template Image<float, 1> filtered_along_rows(const Image<float, 1>&, const Kernel&);
extern template Image<float, 1> filtered_along_columns(const Image<float, 1>&, const Kernel&);
extern template Image<double, 1> filtered_along_rows(const Image<double, 1>&, const Kernel&);
extern template Image<double, 1> filtered_along_columns(const Image<double, 1>&, const Kernel&);

}  // namespace cyclorama
