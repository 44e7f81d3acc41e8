// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <variant>

#include "appliance/warp/warp_mesh.h"
#include "appliance/warp/warp_patches.h"
#include "common/image/image.h"

namespace cyclorama::warp {

/// Position in the picture of each projector pixel's centre: in a panorama azimuth_rad, tan_elevation; in others
/// PicturePlace's across, up; NaN if there is none. For warps that no mesh follows: free-form walls, measured maps.
using PixelMap = Image<float, 2>;

/// A projector's warp, by the simplest model that is exact enough.
using Warp = std::variant<WarpMesh, PixelMap, WarpPatches>;

[[nodiscard]] PixelMap make_pixel_map(const ProjectorMap& map, const PictureShape& picture);

/// True if a mesh's cells, cut along the wall's creases, are large enough that drawing them is faster than reading a
/// map of each pixel.
[[nodiscard]] bool is_quicker_than_a_map(const WarpMesh& mesh);

/// Returns patches that keep to `tolerance_px`, if there are any; else a mesh that does, if it is_quicker_than_a_map();
/// else a pixel map. Errors: kInvalidArgument if the picture's shape is invalid.
Result<Warp> make_warp(const ProjectorMap& map, const PictureShape& picture, double tolerance_px = 0.05);

/// Size of the whole head, in projector pixels.
[[nodiscard]] int width_px(const Warp& warp);
[[nodiscard]] int height_px(const Warp& warp);
/// Empty where nothing is drawn. Precondition: the pixel is inside the head.
[[nodiscard]] std::optional<PanoramaDirection> direction_at(const Warp& warp, int x, int y);

}  // namespace cyclorama::warp
