// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/features/instruction_counter.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace cyclorama {

Result<InstructionCounter> InstructionCounter::open() {
  constexpr pid_t kThisThread = 0;
  constexpr int kAnyProcessor = -1;
  constexpr int kNoGroup = -1;
  perf_event_attr wanted{};
  wanted.size = sizeof(wanted);
  wanted.type = PERF_TYPE_HARDWARE;
  wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
  wanted.exclude_kernel = 1;
  wanted.exclude_hv = 1;
  const long fd = ::syscall(SYS_perf_event_open, &wanted, kThisThread, kAnyProcessor, kNoGroup, PERF_FLAG_FD_CLOEXEC);
  if (fd < 0) return Error::from_errno("counting instructions");
  return InstructionCounter(UniqueFd(static_cast<int>(fd)));
}

Result<std::uint64_t> InstructionCounter::count() const {
  std::uint64_t counted = 0;
  if (::read(fd_.get(), &counted, sizeof(counted)) != static_cast<ssize_t>(sizeof(counted))) {
    return Error::from_errno("reading the counted instructions");
  }
  return counted;
}

}  // namespace cyclorama
