// SPDX-License-Identifier: Apache-2.0
/// Divides a block into JPEG tiles: the node cuts by it, and the coordinator derives from it which tiles are missing.
#pragma once

#include <vector>

#include "common/base/picture_cut.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::balance {

/// Measured with `./bench.sh jpeg`: smaller tiles cost bytes, larger ones arrive later.
inline constexpr int kMaxTilePx = 256;

/// Returns tiles of nearly equal size that cover the block exactly, row by row from the top; none for an empty block.
/// Cuts lie at multiples of kCutPx from the block's corner. A tile, divided again, yields itself.
[[nodiscard]] std::vector<PixelRect> tiles_of(const PixelRect& block);

}  // namespace cyclorama::balance
