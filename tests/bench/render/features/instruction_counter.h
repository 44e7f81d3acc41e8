// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/base/result.h"
#include "common/base/unique_fd.h"

namespace cyclorama {

/// Instructions that a thread retired in user space, by the processor's own counter. Source: perf_event_open(2).
/// Thread-bound: counts the thread that opened it.
class InstructionCounter {
 public:
  /// Fails as the system says where the machine does not count (most virtual ones) or does not let us
  /// (perf_event_paranoid): what is measured is then told without.
  static Result<InstructionCounter> open();
  /// Since it was opened.
  [[nodiscard]] Result<std::uint64_t> count() const;

 private:
  explicit InstructionCounter(UniqueFd fd) : fd_(std::move(fd)) {}
  UniqueFd fd_;
};

}  // namespace cyclorama
