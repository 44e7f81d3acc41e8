// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"

namespace cyclorama {

/// Another computer's clock: the machine's own, ahead by `skew` when it was made, and faster by `drift_ppm` ever since.
/// Thread-safe.
class FakeSkewedClock final : public Clock {
 public:
  FakeSkewedClock(Duration skew, double drift_ppm) : skew_(skew), rate_(1.0 + 1e-6 * drift_ppm) {}

  [[nodiscard]] TimePoint now() const override {
    return made_at_ + skew_ + scaled(SteadyClock().now() - made_at_, rate_);
  }
  void wait_until(TimePoint t) const override { SteadyClock().wait_until(true_time(t)); }
  /// What the machine's clock showed when this one showed `t`.
  [[nodiscard]] TimePoint true_time(TimePoint t) const { return made_at_ + scaled(t - skew_ - made_at_, 1.0 / rate_); }

 private:
  static Duration scaled(Duration d, double factor) {
    return std::chrono::duration_cast<Duration>(std::chrono::duration<double, Duration::period>(d) * factor);
  }
  const TimePoint made_at_ = SteadyClock().now();
  const Duration skew_;
  const double rate_;
};

}  // namespace cyclorama
