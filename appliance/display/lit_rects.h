// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/head_colour.h"
#include "appliance/warp/warp_patches.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::display {

/// A rectangle of a patch.
struct LitRect {
  PixelRect part;         ///< In pixels of the head.
  std::size_t patch = 0;  ///< Index into WarpPatches::patches.
};

/// A head's patches, cut into rectangles by the effect of the mask: few rectangles, cut along the tile borders of
/// rasterisers. Areas that the mask blackens and that get no black lift are omitted.
struct LitRects {
  std::vector<LitRect> whole;   ///< The mask is 1 at all of their pixels.
  std::vector<LitRect> masked;  ///< All others.
};

/// Precondition: mask, warp and black lift, if there is any, have the same size.
[[nodiscard]] LitRects lit_rects(const warp::WarpPatches& warp, const warp::MaskImage& mask,
                                 const warp::BlackLiftImage* black_lift = nullptr);

}  // namespace cyclorama::display
