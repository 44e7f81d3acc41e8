// SPDX-License-Identifier: Apache-2.0
/// Filters whose kernel is the product of a column and a row, so that the cost is linear in the radius. Reentrant.
#pragma once

#include <vector>

#include "common/image/image.h"

namespace cyclorama::quality {

/// An odd number of weights. The middle weight applies to the pixel itself.
using Kernel = std::vector<double>;

/// Returns exp(-x² / (2σ²)) for x in [-radius, radius]. Preconditions: `radius` >= 0, `sigma_px` > 0.
[[nodiscard]] Kernel gaussian(int radius, double sigma_px);

[[nodiscard]] double sum_of(const Kernel& kernel);
/// Scales the kernel to a sum of 1. Precondition: its sum is not 0.
[[nodiscard]] Kernel normalized(Kernel kernel);

/// Return the weighted sum of each pixel's neighbourhood. This is a correlation: the first weights apply to the pixels
/// on the left or above. Beyond the border, the outermost pixels are repeated.
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

}  // namespace cyclorama::quality
