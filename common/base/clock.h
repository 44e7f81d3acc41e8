// SPDX-License-Identifier: Apache-2.0
/// Time is CLOCK_MONOTONIC, which V4L2 and DRM also report. Code receives its clock from the caller, so that tests
/// control time.
#pragma once

#include <chrono>
#include <cstdint>
#include <thread>

namespace cyclorama {

using TimePoint = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

/// A source of time. Thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Blocks until now() has reached `t`. The clock of a test advances itself to `t` instead.
  virtual void wait_until(TimePoint t) const { std::this_thread::sleep_until(t); }

 protected:
  Clock() = default;
  Clock(const Clock&) = default;
  Clock& operator=(const Clock&) = default;
};

/// The machine's own clock. Stateless: construct one wherever it is needed.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return std::chrono::steady_clock::now(); }
};

/// Conversions for the wire and for pages. A time point is meaningful only on the machine that made it.
[[nodiscard]] inline std::int64_t to_nanoseconds(TimePoint t) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
}
[[nodiscard]] inline TimePoint from_nanoseconds(std::int64_t ns) {
  return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(ns)));
}
[[nodiscard]] inline double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
[[nodiscard]] inline double to_milliseconds(Duration d) { return 1e3 * to_seconds(d); }

}  // namespace cyclorama
