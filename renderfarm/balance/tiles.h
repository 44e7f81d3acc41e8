// SPDX-License-Identifier: Apache-2.0
/// Divides a block into JPEG tiles. A node cuts the block into these tiles, and the coordinator derives which of them
/// are missing.
#pragma once

#include <vector>

#include "common/base/picture_cut.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::balance {

/// Chosen by `./bench.sh jpeg`: smaller tiles cost bytes, larger tiles arrive later.
inline constexpr int kMaxTilePx = 256;

/// Returns tiles of nearly equal size that cover the block exactly, row by row from the top; none for an empty block.
/// Cuts are at multiples of kCutPx from the block's corner. Dividing a tile again yields the tile itself.
[[nodiscard]] std::vector<PixelRect> tiles_of(const PixelRect& block);

}  // namespace cyclorama::balance
