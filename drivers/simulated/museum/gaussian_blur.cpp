// SPDX-License-Identifier: Apache-2.0
#include "drivers/simulated/museum/gaussian_blur.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/base/vector_clones.h"
#include "drivers/simulated/museum/parallel_rows.h"

namespace cyclorama::simulated {
namespace {

/// Half of the kernel, from its centre. The variance of a sampled Gaussian narrower than a pixel differs from its
/// nominal one, so the width is found by bisection.
std::vector<float> half_kernel(double sigma) {
  const int radius = std::max(2, static_cast<int>(std::ceil(4.0 * sigma)));
  std::vector<double> weights(static_cast<std::size_t>(radius) + 1);
  const auto fill = [&](double width) {
    double sum = 0.0;
    double variance = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double x = static_cast<double>(i);
      weights[i] = std::exp(-0.5 * x * x / (width * width));
      sum += (i == 0 ? 1.0 : 2.0) * weights[i];
      variance += 2.0 * x * x * weights[i];
    }
    for (double& weight : weights) weight /= sum;
    return variance / sum;
  };
  double low = 0.05;
  double high = 2.0 * sigma + 0.5;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (fill(middle) < sigma * sigma ? low : high) = middle;
  }
  return {weights.begin(), weights.end()};
}

CYCLORAMA_VECTOR_CLONES
void add_scaled(float* to, const float* a, const float* b, float weight, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += weight * (a[i] + b[i]);
}

CYCLORAMA_VECTOR_CLONES
void set_scaled(float* to, const float* from, float weight, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] = weight * from[i];
}

}  // namespace

void blur_plane(std::vector<float>* plane, int width, int height, double sigma_px, int threads) {
  if (!(sigma_px > 0.0) || width < 1 || height < 1) return;
  const std::vector<float> kernel = half_kernel(sigma_px);
  const auto columns = static_cast<std::size_t>(width);
  const int radius = static_cast<int>(kernel.size()) - 1;
  std::vector<float> between(plane->size());
  for_rows(height, threads, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      float* to = between.data() + static_cast<std::size_t>(y) * columns;
      const auto row = [&](int j) {
        return plane->data() + static_cast<std::size_t>(std::clamp(j, 0, height - 1)) * columns;
      };
      set_scaled(to, row(y), kernel[0], columns);
      for (int k = 1; k <= radius; ++k)
        add_scaled(to, row(y - k), row(y + k), kernel[static_cast<std::size_t>(k)], columns);
    }
  });
  for_rows(height, threads, [&](int begin, int end) {
    std::vector<float> padded(columns + 2 * static_cast<std::size_t>(radius));
    for (int y = begin; y < end; ++y) {
      const float* from = between.data() + static_cast<std::size_t>(y) * columns;
      std::fill_n(padded.begin(), radius, from[0]);
      std::copy_n(from, columns, padded.begin() + radius);
      std::fill_n(padded.end() - radius, radius, from[columns - 1]);
      const float* middle = padded.data() + radius;
      float* to = plane->data() + static_cast<std::size_t>(y) * columns;
      set_scaled(to, middle, kernel[0], columns);
      for (int k = 1; k <= radius; ++k)
        add_scaled(to, middle - k, middle + k, kernel[static_cast<std::size_t>(k)], columns);
    }
  });
}

}  // namespace cyclorama::simulated
