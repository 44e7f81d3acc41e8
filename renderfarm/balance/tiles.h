// SPDX-License-Identifier: Apache-2.0
/// How a block is cut into JPEG tiles: the node cuts by it, and the head knows from it what is still missing.
#pragma once

#include <vector>

#include "common/base/picture_cut.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {

/// As measured by `./bench.sh jpeg`: smaller tiles cost bytes, larger ones come later.
inline constexpr int kLargestTilePx = 256;

/// Tiles of nearly equal size that cover the block exactly, row by row from the top; none for an empty block.
/// Cuts lie at multiples of kCutPx from the block's corner. A tile's only tile is itself.
[[nodiscard]] std::vector<PixelRect> tiles_of(const PixelRect& block);

}  // namespace cyclorama
