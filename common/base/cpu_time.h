// SPDX-License-Identifier: Apache-2.0
/// CPU time of a thread; waiting does not count. Thread-safe.
#pragma once

#include <time.h>

#include "common/base/check.h"

namespace cyclorama {

/// Returns the calling thread's CPU time in seconds since a fixed origin.
[[nodiscard]] inline double thread_cpu_seconds() {
  timespec time{};
  CHECK(::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) == 0);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace cyclorama
