// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::node {

/// One stream to a coordinator, for as long as the process lives: coordinators number their blocks and sessions each for itself.
using LinkId = std::uint64_t;

}  // namespace cyclorama::node
