// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/structured_light/decoded.h"

namespace cyclorama::structured_light {

/// Takes out what stands alone: decoded pixels hang together where neighbours' places differ by no more than a step of
/// the wall's own slope, and a patch of fewer than `min_patch_px` pixels contradicts its neighbours. A wall's corner, or
/// a pillar's edge, parts two patches and costs neither. The slope is the picture's own (median), at least a pixel.
void remove_small_patches(int min_patch_px, Decoded* decoded);

}  // namespace cyclorama::structured_light
