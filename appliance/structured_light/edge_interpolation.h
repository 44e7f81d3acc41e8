// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/structured_light/bit_reading.h"
#include "common/image/image.h"

namespace cyclorama::structured_light {

/// Positions on one axis, with their standard deviations; sigma_px is negative where the position is unknown.
struct AxisPositions {
  Image<float, 1> position_px;
  Image<float, 1> sigma_px;
};

/// Returns subpixel positions, interpolated between the edges of the stripes.
///
///     pattern  ▔▔▔╲      ╱▔▔      at an edge a pattern and its inverse are equally bright, whatever the wall's
///                  ╳    ╳         colour, the blur or the stripes' shape. Between two edges in a row (or column) of
///     inverse  ▁▁▁╱      ╲▁▁      the photograph, positions are interpolated.
///                  e      e+1
///
/// If the finest stripes cannot be read, stripes twice as wide are tried, up to a factor of eight. A pixel with a
/// stripe but without edges gets the stripe's middle. `is_lit` marks the pixels with light; a line of the photograph is
/// followed only through these pixels. Source: Trobina, "Error model of a coded-light range sensor", ETH Zürich
/// BIWI-TR-164, 1995.
[[nodiscard]] AxisPositions interpolate_edges(const AxisBits& axis, const StripeReading& reading,
                                              const Image<float, 1>& amplitude, const Image<std::uint8_t, 1>& is_lit,
                                              double noise);

}  // namespace cyclorama::structured_light
