// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Returns a picture that shows a region, at the map's size. Red increases with u (or x) and green with v (or y), with
/// a line at each tenth, dimmed by the alpha; unmapped pixels are dark blue. Precondition: the region has a map.
[[nodiscard]] RgbImage picture_of(const WarpRegion& region);

/// Returns the share of a region's samples that are mapped, 0 to 1; 0 without a map.
[[nodiscard]] double mapped_fraction(const WarpRegion& region);

}  // namespace cyclorama::interchange
