// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

namespace cyclorama {

/// The calling thread, and every thread that it starts from now on, gives way to the process's others: `steps` of
/// nice(2) more. Where the system refuses, all stays as it was.
inline void give_way(int steps) {
  // On Linux the calling thread's alone; setpriority(2), "C library/kernel differences".
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + steps);
}

}  // namespace cyclorama
