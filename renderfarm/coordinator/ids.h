// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::coordinator {

/// A node's or a museum's stream; counts from 1 and never comes again while the coordinator runs.
enum class NodeId : std::uint64_t {};
enum class SessionId : std::uint64_t {};

}  // namespace cyclorama::coordinator
