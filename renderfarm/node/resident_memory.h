// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::node {

/// Returns the resident set size of this process; 0 if /proc is not available. Thread-safe.
[[nodiscard]] std::uint64_t resident_memory_bytes();

}  // namespace cyclorama::node
