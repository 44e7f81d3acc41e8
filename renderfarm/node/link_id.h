// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama {

/// One stream to a head, for as long as the process lives: heads number their blocks and visits each for itself.
using LinkId = std::uint64_t;

}  // namespace cyclorama
