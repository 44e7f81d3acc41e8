// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama::node {

/// Identifies one stream to a coordinator; never reused in the process. Blocks and sessions are numbered per stream.
using LinkId = std::uint64_t;

}  // namespace cyclorama::node
