// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::coordinator {

/// Identifies a stream of a node or a museum; counts from 1 and is never reused while the coordinator runs.
enum class NodeId : std::uint64_t {};
enum class SessionId : std::uint64_t {};
/// Identifies the account of a museum (see Accounts).
enum class AccountId : std::uint64_t {};

}  // namespace cyclorama::coordinator
