// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"

namespace cyclorama {

/// The clock of another computer: ahead of the machine's clock by `skew` at construction, and faster by `drift_ppm`
/// from then on. Thread-safe.
class FakeSkewedClock final : public Clock {
 public:
  FakeSkewedClock(Duration skew, double drift_ppm) : skew_(skew), rate_(1.0 + 1e-6 * drift_ppm) {}

  [[nodiscard]] TimePoint now() const override {
    return made_at_ + skew_ + scaled(SteadyClock().now() - made_at_, rate_);
  }
  void wait_until(TimePoint t) const override { SteadyClock().wait_until(true_time(t)); }
  /// Returns the machine's time at which this clock showed `t`.
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
