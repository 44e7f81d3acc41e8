// SPDX-License-Identifier: Apache-2.0
/// Time is CLOCK_MONOTONIC (what V4L2 and DRM report), and it is given to the code that needs it, so that tests move it.
#pragma once

#include <chrono>
#include <cstdint>
#include <thread>

namespace cyclorama {

using TimePoint = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

/// Thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Returns once now() has reached `t`; blocks. A test's clock moves itself there instead.
  virtual void wait_until(TimePoint t) const { std::this_thread::sleep_until(t); }

 protected:
  Clock() = default;
  Clock(const Clock&) = default;
  Clock& operator=(const Clock&) = default;
};

/// The machine's own clock. Stateless; make one where it is needed.
class SteadyClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return std::chrono::steady_clock::now(); }
};

/// For the wire and for pages. A time point means something only on the machine that made it.
[[nodiscard]] inline std::int64_t to_nanoseconds(TimePoint t) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
}
[[nodiscard]] inline TimePoint from_nanoseconds(std::int64_t ns) {
  return TimePoint(std::chrono::duration_cast<Duration>(std::chrono::nanoseconds(ns)));
}
[[nodiscard]] inline double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
[[nodiscard]] inline double to_milliseconds(Duration d) { return 1e3 * to_seconds(d); }

}  // namespace cyclorama
