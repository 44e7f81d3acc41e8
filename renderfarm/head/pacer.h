// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/base/clock.h"

namespace cyclorama {

/// Keeps a stream of pieces to a mean rate: a piece may go as soon as those before it are paid for. Thread-bound.
class Pacer {
 public:
  /// 0: no limit.
  explicit Pacer(double bytes_per_second) : bytes_per_second_(bytes_per_second) {}

  /// When the next piece may go: not after `now` if it may at once.
  [[nodiscard]] TimePoint next() const { return next_; }
  /// A piece went. Time that was not used is not saved up.
  void spend(std::uint64_t bytes, TimePoint now) {
    if (bytes_per_second_ <= 0.0) return;
    const std::chrono::duration<double> cost(static_cast<double>(bytes) / bytes_per_second_);
    next_ = std::max(next_, now) + std::chrono::duration_cast<Duration>(cost);
  }

 private:
  const double bytes_per_second_;
  TimePoint next_{};
};

}  // namespace cyclorama
