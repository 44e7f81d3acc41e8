// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/base/clock.h"

namespace cyclorama {

/// A rate, with a reserve for bursts. Takes always succeed, and say when they are paid for; more may go once they are.
/// A value; thread-bound.
class TokenBucket {
 public:
  /// `per_second` 0: not limited. `burst`: how much may be taken at once from a full bucket; 0: time that was not used is
  /// not saved up.
  TokenBucket(double per_second, double burst)
      : per_second_(per_second), reserve_(per_second > 0.0 ? from_seconds(burst / per_second) : Duration::zero()) {}

  /// When all that was taken is paid for.
  [[nodiscard]] TimePoint paid_at() const { return paid_at_; }

  /// When `amount` is paid for: `now`, or later when too much was taken before.
  TimePoint take(double amount, TimePoint now) {
    if (per_second_ <= 0.0) return now;
    paid_at_ = std::max(paid_at_, now - reserve_) + from_seconds(amount / per_second_);
    return std::max(paid_at_, now);
  }

 private:
  static Duration from_seconds(double seconds) {
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
  }
  double per_second_;
  Duration reserve_;
  TimePoint paid_at_{};
};

}  // namespace cyclorama
