// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <variant>

#include "appliance/warp/warp_mesh.h"
#include "appliance/warp/warp_patches.h"
#include "common/image/image.h"

namespace cyclorama::warp {

/// Position in the picture of each projector pixel's centre: in a panorama azimuth_rad and tan_elevation, in other
/// pictures PicturePlace's across and up; NaN if there is none. For warps that a mesh cannot follow: free-form walls,
/// measured maps.
using PixelMap = Image<float, 2>;

/// A projector's warp, as the simplest model that is exact enough.
using Warp = std::variant<WarpMesh, PixelMap, WarpPatches>;

[[nodiscard]] PixelMap make_pixel_map(const ProjectorMap& map, const PictureShape& picture);

/// True if a mesh's cells, cut along the wall's creases, are so large that drawing them is faster than reading a pixel
/// map.
[[nodiscard]] bool is_quicker_than_a_map(const WarpMesh& mesh);

/// Returns patches that deviate by at most `tolerance_px`, if that is possible; else such a mesh, if
/// is_quicker_than_a_map(); else a pixel map. Errors: kInvalidArgument if the picture's shape is invalid.
Result<Warp> make_warp(const ProjectorMap& map, const PictureShape& picture, double tolerance_px = 0.05);

/// Size of the whole head, in projector pixels.
[[nodiscard]] int width_px(const Warp& warp);
[[nodiscard]] int height_px(const Warp& warp);
/// Returns the direction of a pixel's centre; empty where nothing is drawn. Precondition: the pixel is inside the head.
[[nodiscard]] std::optional<PanoramaDirection> direction_at(const Warp& warp, int x, int y);

}  // namespace cyclorama::warp
