// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

namespace cyclorama {

/// Lowers the priority of the calling thread, and of every thread that it starts from now on, by `steps` of nice(2). If
/// the system refuses, nothing changes.
inline void give_way(int steps) {
  // On Linux this affects the calling thread only; see setpriority(2), "C library/kernel differences".
  setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + steps);
}

}  // namespace cyclorama
