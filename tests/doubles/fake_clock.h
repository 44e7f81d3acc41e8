// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "common/base/clock.h"

namespace cyclorama {

/// A clock that advances only if a test advances it or a thread waits on it. Thread-safe.
class FakeClock final : public Clock {
 public:
  explicit FakeClock(TimePoint start = TimePoint(std::chrono::seconds(1000))) : now_(start) {}
  [[nodiscard]] TimePoint now() const override { return now_.load(); }
  void wait_until(TimePoint t) const override {
    if (t > now_.load()) now_.store(t);
  }
  void set(TimePoint t) { now_.store(t); }
  void advance(Duration by) { now_.store(now_.load() + by); }

 private:
  mutable std::atomic<TimePoint> now_;
};

}  // namespace cyclorama
