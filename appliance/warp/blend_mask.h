// SPDX-License-Identifier: Apache-2.0
/// Blending of several projectors: the weights at each point of the wall add up to one.
#pragma once

#include <vector>

#include "appliance/warp/projector_map.h"
#include "common/image/image.h"

namespace cyclorama::warp {

using MaskImage = Image<float, 1>;  ///< A factor in [0, 1] on linear light per projector pixel.

/// Returns the maps of all projectors of an installation, in the installation's order.
[[nodiscard]] std::vector<ProjectorMap> projector_maps(const Installation& installation);

/// Returns the weights of the projectors at one point of the wall. They add up to 1, and each fades smoothly to 0 at
/// the edges of its projector's picture. All are 0 if no projector reaches the point.
///
/// weight_i = r_i / sum of r, r = (x (W - x) y (H - y) / (W H / 4)^2)^2, for the pixel (x, y) that lights the point. It
/// is a product, because then the distances to the upper and lower edge cancel where two pictures lie side by side. It
/// is squared, so that the ramp from 0 to 1 starts and ends with slope 0. At the edge of a shadow that one part of a
/// wall casts on another, the weights have a step, but still add up to 1.
[[nodiscard]] std::vector<double> blend_weights(const std::vector<ProjectorMap>& maps, const Point<frame::Room>& point);

/// Returns one mask per projector, sampled at pixel centres; 0 for pixels that miss the wall.
[[nodiscard]] std::vector<MaskImage> make_blend_masks(const std::vector<ProjectorMap>& maps);

/// Returns the share of the wall's area that no projector reaches, in [0, 1], from a grid of wall points.
[[nodiscard]] double unlit_fraction(const Installation& installation);

}  // namespace cyclorama::warp
