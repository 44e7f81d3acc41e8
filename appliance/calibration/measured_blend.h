// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "appliance/calibration/measured_map.h"
#include "appliance/warp/blend_mask.h"

namespace cyclorama::calibration {

/// make_blend_masks() of measured maps: the same weights, of places in the picture instead of points of the wall. Null:
/// a projector of which nothing is known; its mask is empty, and the others blend without it. Where a map has no
/// direction a pixel is dark. They add up to 1 within half a percent on heads of 160 pixels, and the better the more
/// pixels there are. Reentrant.
[[nodiscard]] std::vector<warp::MaskImage> measured_blend_masks(std::span<const MeasuredMap* const> maps,
                                                                const PictureShape& picture);

}  // namespace cyclorama::calibration
