// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/structured_light/bit_reading.h"
#include "common/image/image.h"

namespace cyclorama::structured_light {

/// A place on one axis, and how sure it is. sigma_px < 0: nothing known.
struct AxisPositions {
  Image<float, 1> position_px;
  Image<float, 1> sigma_px;
};

/// PicturePositions finer than a pixel, from the edges of the stripes.
///
///     pattern  ▔▔▔╲      ╱▔▔      where a pattern and its inverse are equally bright, there is the edge, whatever the
///                  ╳    ╳         wall's colour, the blur or the stripes' shape. Between two edges in a row (or a
///     inverse  ▁▁▁╱      ╲▁▁      column) of the photograph, places are interpolated.
///                  e      e+1
///
/// Where the finest stripes cannot be read, those twice as wide are tried, up to eight times. A pixel that has only its
/// stripe and no edges gets the stripe's middle. `is_lit`: which pixels have light; a line of the photograph is
/// followed only through these. Source: Trobina, "Error model of a coded-light range sensor", ETH Zürich BIWI-TR-164,
/// 1995.
[[nodiscard]] AxisPositions interpolate_edges(const AxisBits& axis, const StripeReading& reading,
                                              const Image<float, 1>& amplitude, const Image<std::uint8_t, 1>& is_lit,
                                              double noise);

}  // namespace cyclorama::structured_light
