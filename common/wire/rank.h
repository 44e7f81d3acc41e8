// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cyclorama {

/// Smallest RenderBlock.rank of pictures at rest, which come after all moving ones.
inline constexpr std::uint64_t kRankAtRest = std::uint64_t{1} << 62;

}  // namespace cyclorama
