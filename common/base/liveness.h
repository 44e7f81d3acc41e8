// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "common/base/clock.h"

namespace cyclorama {

/// A deadline for the next report of work that must go on. The thread that works moves the deadline, and the main loop
/// feeds the process's watchdog only while it is not over. Thread-safe.
class Liveness {
 public:
  /// The next report comes by `deadline`.
  void expect_by(TimePoint deadline) { deadline_.store(deadline); }
  /// Nothing is to be done, so no report is expected.
  void rest() { deadline_.store(TimePoint::max()); }
  [[nodiscard]] bool is_alive(TimePoint now) const { return now <= deadline_.load(); }

 private:
  std::atomic<TimePoint> deadline_{TimePoint::max()};
};

}  // namespace cyclorama
