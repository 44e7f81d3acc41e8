// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/separable_filter.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cyclorama::quality {
namespace {

int radius_of(const Kernel& kernel) {
  CHECK(kernel.size() % 2 == 1);
  return static_cast<int>(kernel.size() / 2);
}

/// Computes to[i] += weight * from[i]. Takes most of the time; compilers vectorise it.
template <typename T>
void add_scaled(T* __restrict__ to, const T* __restrict__ from, T weight, int count) {
  for (int i = 0; i < count; ++i) to[i] += weight * from[i];
}

}  // namespace

Kernel gaussian(int radius, double sigma_px) {
  CHECK(radius >= 0 && sigma_px > 0.0);
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(std::exp(-0.5 * x * x / (sigma_px * sigma_px)));
  return kernel;
}

double sum_of(const Kernel& kernel) { return std::accumulate(kernel.begin(), kernel.end(), 0.0); }

Kernel normalized(Kernel kernel) {
  const double sum = sum_of(kernel);
  CHECK(sum != 0.0);
  for (double& weight : kernel) weight /= sum;
  return kernel;
}

template <typename T>
Image<T, 1> filtered_along_rows(const Image<T, 1>& plane, const Kernel& kernel) {
  if (plane.empty()) return plane;
  const int radius = radius_of(kernel);
  const int width = plane.width();
  Image<T, 1> result(width, plane.height());
  std::vector<T> row(static_cast<std::size_t>(width) + 2 * static_cast<std::size_t>(radius));
  for (int y = 0; y < plane.height(); ++y) {
    const T* const from = plane.at(0, y);
    std::fill_n(row.begin(), radius, from[0]);
    std::copy_n(from, width, row.begin() + radius);
    std::fill_n(row.begin() + radius + width, radius, from[width - 1]);
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      add_scaled(result.at(0, y), row.data() + k, static_cast<T>(kernel[k]), width);
    }
  }
  return result;
}

template <typename T>
Image<T, 1> filtered_along_columns(const Image<T, 1>& plane, const Kernel& kernel) {
  if (plane.empty()) return plane;
  const int radius = radius_of(kernel);
  Image<T, 1> result(plane.width(), plane.height());
  for (int y = 0; y < plane.height(); ++y) {
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const int from = std::clamp(y + static_cast<int>(k) - radius, 0, plane.height() - 1);
      add_scaled(result.at(0, y), plane.at(0, from), static_cast<T>(kernel[k]), plane.width());
    }
  }
  return result;
}

template Image<float, 1> filtered_along_rows(const Image<float, 1>&, const Kernel&);
template Image<float, 1> filtered_along_columns(const Image<float, 1>&, const Kernel&);
template Image<double, 1> filtered_along_rows(const Image<double, 1>&, const Kernel&);
template Image<double, 1> filtered_along_columns(const Image<double, 1>&, const Kernel&);

}  // namespace cyclorama::quality
