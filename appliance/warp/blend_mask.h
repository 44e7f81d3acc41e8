// SPDX-License-Identifier: Apache-2.0
/// How several projectors share the wall: each place's light adds up to one.
#pragma once

#include <vector>

#include "appliance/warp/projector_map.h"
#include "common/image/image.h"

namespace cyclorama::warp {

using MaskImage = Image<float, 1>;  ///< A factor in [0, 1] on linear light per projector pixel.

/// The maps of all of an installation's projectors, in its order.
[[nodiscard]] std::vector<ProjectorMap> projector_maps(const Installation& installation);

/// Weights of one wall point over the projectors: they add up to 1, and each fades smoothly to 0 at the edges of that
/// projector's picture. All 0 where no projector reaches.
///
/// weight_i = r_i / sum of r, r = (x (W - x) y (H - y) / (W H / 4)^2)^2, for the pixel (x, y) that lights the point.
/// A product, because where two pictures lie side by side their distances to the upper and lower edge cancel, and the
/// square, because its ramp from 0 to 1 starts and ends with slope 0. Where one part of a wall shades another, the weights
/// step from one side of the shade's edge to the other, and still add up to 1.
[[nodiscard]] std::vector<double> blend_weights(const std::vector<ProjectorMap>& maps, const Point<frame::Room>& point);

/// One mask per projector, sampled at pixel centres; 0 where the pixel misses the wall.
[[nodiscard]] std::vector<MaskImage> make_blend_masks(const std::vector<ProjectorMap>& maps);

/// The part of the wall that no projector reaches, in [0, 1], by area, of a grid of wall points.
[[nodiscard]] double unlit_fraction(const Installation& installation);

}  // namespace cyclorama::warp
