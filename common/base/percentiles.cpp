// SPDX-License-Identifier: Apache-2.0
#include "common/base/percentiles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/check.h"

namespace cyclorama {

Percentiles::Percentiles(std::size_t window) : window_(window) { CHECK(window > 0); }

void Percentiles::add(double sample) {
  if (std::isnan(sample)) return;
  ++count_;
  if (samples_.size() < window_) {
    samples_.push_back(sample);
    return;
  }
  samples_[next_] = sample;
  next_ = (next_ + 1) % window_;
}

double Percentiles::mean() const {
  if (samples_.empty()) return 0.0;
  return std::accumulate(samples_.begin(), samples_.end(), 0.0) / static_cast<double>(samples_.size());
}

double Percentiles::at(double fraction) const {
  if (samples_.empty()) return 0.0;
  std::vector<double> sorted = samples_;
  const double rank = std::ceil(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(sorted.size())) - 1.0;
  const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 0.0));
  std::nth_element(sorted.begin(), nth, sorted.end());
  return *nth;
}

}  // namespace cyclorama
