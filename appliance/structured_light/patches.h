// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/structured_light/decoded.h"

namespace cyclorama::structured_light {

/// Removes isolated pixels. Neighbouring decoded pixels are connected if their positions differ by little more than the
/// usual step, which is the median over the picture, at least a pixel. The pixels of a patch of fewer than
/// `min_patch_px` become kContradictsNeighbours. A corner of the wall, or the edge of a pillar, separates two patches
/// and removes neither.
void remove_small_patches(int min_patch_px, Decoded* decoded);

}  // namespace cyclorama::structured_light
