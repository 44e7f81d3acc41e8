// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// Instructions that a thread retired in user space, from the processor's counter. Source: perf_event_open(2).
/// Thread-bound: counts the thread that opened it.
class InstructionCounter {
 public:
  /// Fails with the system's error if the machine has no counter (most virtual ones) or access is denied
  /// (perf_event_paranoid); the measurement then omits instructions.
  static Result<InstructionCounter> open();
  /// Instructions since open().
  [[nodiscard]] Result<std::uint64_t> count() const;

 private:
  explicit InstructionCounter(UniqueFd fd) : fd_(std::move(fd)) {}
  UniqueFd fd_;
};

}  // namespace cyclorama
