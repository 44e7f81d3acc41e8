// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::node {

/// What of this process is in memory now; 0 where /proc does not say. Thread-safe.
[[nodiscard]] std::uint64_t resident_memory_bytes();

}  // namespace cyclorama::node
