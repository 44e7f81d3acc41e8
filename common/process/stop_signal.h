// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/clock.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// SIGTERM and SIGINT, turned into a value that a loop waits for. Make it first thing in main, before any thread starts:
/// it blocks the signals for all of them, and ignores SIGPIPE. Thread-safe after construction.
class StopSignal {
 public:
  StopSignal();
  /// True once the process was asked to stop; waits for that until `deadline`.
  [[nodiscard]] bool wait_until(TimePoint deadline) const;
  [[nodiscard]] bool requested() const { return wait_until(TimePoint{}); }
  /// Readable when the process was asked to stop; for poll().
  [[nodiscard]] int fd() const { return fd_.get(); }

 private:
  UniqueFd fd_;
};

}  // namespace cyclorama
