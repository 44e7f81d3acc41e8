// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/resident_memory.h"

#include <unistd.h>

#include <fstream>

namespace cyclorama::node {

std::uint64_t resident_memory_bytes() {
  std::ifstream statm("/proc/self/statm");  // Unit: pages. Fields: size, resident, ... (proc(5)).
  std::uint64_t size = 0;
  std::uint64_t resident = 0;
  if (!(statm >> size >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace cyclorama::node
