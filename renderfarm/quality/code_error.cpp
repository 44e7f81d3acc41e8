// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/code_error.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "renderfarm/quality/comparable.h"
#include "renderfarm/quality/separable_filter.h"

namespace cyclorama::quality {
namespace {

/// Uses double, because a variance is a small difference between large means of squares.
using Plane = Image<double, 1>;

Plane luma_of(const RgbImage& picture) {
  Plane luma(picture.width(), picture.height());
  for (std::size_t i = 0; i < luma.data().size(); ++i) {
    const std::uint8_t* const rgb = &picture.data()[3 * i];
    luma.data()[i] = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
  }
  return luma;
}

Plane product(const Plane& a, const Plane& b) {
  Plane product(a.width(), a.height());
  for (std::size_t i = 0; i < a.data().size(); ++i) product.data()[i] = a.data()[i] * b.data()[i];
  return product;
}

}  // namespace

Result<double> psnr(const RgbImage& picture, const RgbImage& reference) {
  TRY(check_same_size(picture.width(), picture.height(), reference.width(), reference.height()));
  double sum = 0.0;
  for (std::size_t i = 0; i < picture.data().size(); ++i) {
    const double difference = picture.data()[i] - reference.data()[i];
    sum += difference * difference;
  }
  if (sum == 0.0) return std::numeric_limits<double>::infinity();
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(picture.data().size()) / sum);
}

Result<double> ssim(const RgbImage& picture, const RgbImage& reference) {
  TRY(check_same_size(picture.width(), picture.height(), reference.width(), reference.height()));
  if (picture.width() < kSsimWindowPx || picture.height() < kSsimWindowPx) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("SSIM looks at windows of {0}x{0} pixels; the pictures have {1}x{2}", kSsimWindowPx,
                             picture.width(), picture.height()));
  }
  constexpr int kRadius = kSsimWindowPx / 2;
  constexpr double kC1 = (0.01 * 255.0) * (0.01 * 255.0);
  constexpr double kC2 = (0.03 * 255.0) * (0.03 * 255.0);
  const Kernel window = normalized(gaussian(kRadius, 1.5));
  const auto mean = [&](const Plane& plane) { return filtered(plane, window, window); };
  const Plane x = luma_of(picture);
  const Plane y = luma_of(reference);
  const Plane mean_x = mean(x);
  const Plane mean_y = mean(y);
  const Plane mean_xx = mean(product(x, x));
  const Plane mean_yy = mean(product(y, y));
  const Plane mean_xy = mean(product(x, y));
  double sum = 0.0;
  for (int v = kRadius; v < x.height() - kRadius; ++v) {
    for (int u = kRadius; u < x.width() - kRadius; ++u) {
      const double mx = *mean_x.at(u, v);
      const double my = *mean_y.at(u, v);
      const double variance_x = *mean_xx.at(u, v) - mx * mx;
      const double variance_y = *mean_yy.at(u, v) - my * my;
      const double covariance = *mean_xy.at(u, v) - mx * my;
      sum += (2.0 * mx * my + kC1) * (2.0 * covariance + kC2) /
             ((mx * mx + my * my + kC1) * (variance_x + variance_y + kC2));
    }
  }
  return sum / (static_cast<double>(x.width() - 2 * kRadius) * (x.height() - 2 * kRadius));
}

}  // namespace cyclorama::quality
