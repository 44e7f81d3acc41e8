// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/monotone_curve.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::photometry {

MonotoneCurve::MonotoneCurve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
  CHECK(x_.size() >= 2 && x_.size() == y_.size());
  const std::size_t last = x_.size() - 1;
  const auto secant = [this](std::size_t i) { return (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]); };
  slope_.assign(x_.size(), 0.0);
  if (last == 1) {
    slope_ = {secant(0), secant(0)};
    return;
  }
  for (std::size_t i = 1; i < last; ++i) {
    const double before = x_[i] - x_[i - 1];
    const double after = x_[i + 1] - x_[i];
    slope_[i] = (after * secant(i - 1) + before * secant(i)) / (before + after);  // Slope of a parabola.
  }
  slope_[0] = 2.0 * secant(0) - slope_[1];
  slope_[last] = 2.0 * secant(last - 1) - slope_[last - 1];
  for (std::size_t i = 0; i <= last; ++i) {
    for (const std::size_t k : {i == 0 ? 0 : i - 1, i == last ? last - 1 : i}) {
      const double s = secant(k);
      if (slope_[i] * s <= 0.0) slope_[i] = 0.0;
      if (std::abs(slope_[i]) > 3.0 * std::abs(s)) slope_[i] = 3.0 * s;
    }
  }
}

double MonotoneCurve::at(double x) const {
  if (!(x > x_.front())) return y_.front();
  if (x >= x_.back()) return y_.back();
  const auto upper = std::ranges::upper_bound(x_, x);
  const auto i = static_cast<std::size_t>(upper - x_.begin()) - 1;
  const double width = x_[i + 1] - x_[i];
  const double t = (x - x_[i]) / width;
  const double u = 1.0 - t;
  return y_[i] * u * u * (1.0 + 2.0 * t) + slope_[i] * width * t * u * u + y_[i + 1] * t * t * (3.0 - 2.0 * t) -
         slope_[i + 1] * width * t * t * u;
}

}  // namespace cyclorama::photometry
