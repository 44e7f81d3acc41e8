// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "appliance/calibration/measured_map.h"
#include "appliance/warp/blend_mask.h"

namespace cyclorama::calibration {

/// Counterpart of make_blend_masks() for measured maps: computes the same weights from positions in the picture instead
/// of points of the wall. A null map stands for an unknown projector: its mask is empty, and the others are blended
/// without it. A pixel for which the map has no direction is dark. The weights add up to 1 within half a percent on
/// heads of 160 pixels, and more closely with more pixels. Reentrant.
[[nodiscard]] std::vector<warp::MaskImage> measured_blend_masks(std::span<const MeasuredMap* const> maps,
                                                                const PictureShape& picture);

}  // namespace cyclorama::calibration
