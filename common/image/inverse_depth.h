// SPDX-License-Identifier: Apache-2.0
/// A coarse inverse depth that accompanies a picture. With it, a display shows the picture from a slightly different
/// eye (appliance/display/reprojection_mesh.h).
///
/// There is one value for each cell of 4x4 pixels: that of the *nearest* surface that any of the cell's samples met,
/// because a near edge that wrongly moves with the background is conspicuous, while background that moves with a near
/// edge is not. Values are proportional to the inverse distance along the ray, so that their steps are equal in
/// parallax: 4095 at 0.1 m or nearer, 0 at infinity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/image/image.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {

inline constexpr int kDepthCellPx = 4;
inline constexpr int kMaxInverseDepth = 4095;
inline constexpr double kMinDepth_m = 0.1;

/// Rows of cells from the top; values up to kMaxInverseDepth.
using InverseDepthImage = Image<std::uint16_t, 1>;

/// Returns the value of a distance in metres; infinity and NaN give 0. Reentrant, like all functions here.
[[nodiscard]] std::uint16_t inverse_depth_of(float distance_m);
/// Returns the inverse distance in 1/m.
[[nodiscard]] inline float inverse_metres(std::uint16_t inverse_depth) {
  return static_cast<float>(inverse_depth) * static_cast<float>(1.0 / (kMaxInverseDepth * kMinDepth_m));
}

/// Returns the cells that a rectangle of pixels touches; empty for an empty rectangle. Precondition: x and y are not
/// negative.
[[nodiscard]] PixelRect depth_cells(const PixelRect& pixels);

/// Compresses losslessly: each value is predicted from its neighbours to the left and above (by the median edge
/// detector of LOCO-I: Weinberger, Seroussi and Sapiro 2000), and the differences are compressed by zstd. Never empty.
[[nodiscard]] std::string encode_inverse_depth(const InverseDepthImage& depth);
/// Inverse of encode_inverse_depth(): writes `cells.width` by `cells.height` values to that part of `depth`. Errors:
/// kBadData unless the bytes contain exactly these values, each at most kMaxInverseDepth; `depth` is then unchanged.
/// Precondition: `cells` is not empty and lies inside `depth`.
Status decode_inverse_depth(std::span<const std::byte> bytes, const PixelRect& cells, InverseDepthImage* depth);

}  // namespace cyclorama
