// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Draws a region for people, at the map's size: red grows with u (or x) and green with v (or y), with a line at each
/// tenth, dimmed by its alpha; dark blue where nothing is mapped. Precondition: it has a map.
[[nodiscard]] RgbImage picture_of(const WarpRegion& region);

/// Returns the share of its samples that are mapped, 0 to 1; 0 without a map.
[[nodiscard]] double mapped_fraction(const WarpRegion& region);

}  // namespace cyclorama::interchange
