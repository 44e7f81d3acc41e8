// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "appliance/warp/projector_map.h"
#include "common/base/result.h"

namespace cyclorama::warp {

/// A rectangle of a projector's picture. With s and t in [0, 1] across and down the rectangle, a position is c[0] +
/// c[1] s + c[2] t + c[3] s^2 + c[4] s t + c[5] t^2.
struct WarpPatch {
  std::array<float, 6> across{};  ///< In a panorama: azimuth.
  std::array<float, 6> up{};      ///< In a panorama: tangent of elevation.
};

/// A projector's whole picture cut into equal rectangles. In each, a polynomial of second degree gives the pixels'
/// positions in the panorama or picture. It needs a tenth of the cells of a triangle mesh for the same error, and is
/// much faster on a software rasteriser, which draws pixels on the edges of triangles twice. A value; reentrant.
struct WarpPatches {
  int width_px = 0;
  int height_px = 0;
  int patch_width_px = 0;  ///< The rightmost and the lowest patches may extend beyond the picture.
  int patch_height_px = 0;
  std::vector<WarpPatch> patches;  ///< Row by row from the top.
  double worst_error_px = 0.0;     ///< Maximum deviation from the exact map, on the wall, in the picture's pixels.

  [[nodiscard]] int across() const { return (width_px + patch_width_px - 1) / patch_width_px; }
  [[nodiscard]] int down() const { return (height_px + patch_height_px - 1) / patch_height_px; }
  /// Returns the position of a pixel in the picture. Precondition: the pixel is inside the projector's picture.
  [[nodiscard]] PanoramaDirection at(const Eigen::Vector2d& pixel) const;
};

/// Returns the smallest number of patches that deviate by at most `tolerance_px` of `picture`'s pixels wherever the
/// projector meets the wall. Errors: kInvalidArgument if the picture's shape is invalid; the wall has creases inside
/// the projector's picture; a pixel has no position; or patches would have to be so small that a mesh of triangles, or
/// a pixel map, is as fast.
Result<WarpPatches> make_warp_patches(const ProjectorMap& map, const PictureShape& picture, double tolerance_px);

}  // namespace cyclorama::warp
