// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// SIGTERM and SIGINT as a value for which a loop can wait. To be constructed first in main, before any thread starts:
/// it blocks the signals in all threads, and ignores SIGPIPE. Thread-safe after construction.
class StopSignal {
 public:
  StopSignal();
  /// Waits until `deadline` for a request to stop. Returns true once there was one.
  [[nodiscard]] bool wait_until(TimePoint deadline) const;
  [[nodiscard]] bool requested() const { return wait_until(TimePoint{}); }
  /// Descriptor for poll(); readable once a stop was requested.
  [[nodiscard]] int fd() const { return fd_.get(); }

 private:
  UniqueFd fd_;
};

}  // namespace cyclorama
