// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/base/clock.h"

namespace cyclorama {

/// Limits a rate, with a reserve for bursts, which is full at first. Taking always succeeds, and returns the time from
/// which more may be taken. A value; thread-bound.
class TokenBucket {
 public:
  /// `per_second` 0: no limit. `burst`: amount that may be taken at once from a full bucket; 0: time without use is not
  /// saved up.
  TokenBucket(double per_second, double burst)
      : per_second_(per_second), reserve_(per_second > 0.0 ? from_seconds(burst / per_second) : Duration::zero()) {}

  /// Time from which more may be taken.
  [[nodiscard]] TimePoint paid_at() const { return paid_at_; }

  /// Takes `amount` and returns the time from which more may be taken: `now`, or later if more was taken than allowed.
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
  TimePoint paid_at_ = TimePoint::min();  // The clock may be younger than the burst.
};

}  // namespace cyclorama
