// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <variant>

#include "appliance/warp/warp_mesh.h"
#include "appliance/warp/warp_patches.h"
#include "common/image/image.h"

namespace cyclorama::warp {

/// Where in the picture the centre of each projector pixel lies: in a panorama azimuth_rad, tan_elevation; in others
/// PicturePlace's across, up; NaNs where it lies nowhere. For what no mesh follows: free-form walls, measured maps.
using PixelMap = Image<float, 2>;

/// Where a projector's pixels lie, by the lesser model that is exact enough.
using Warp = std::variant<WarpMesh, PixelMap, WarpPatches>;

[[nodiscard]] PixelMap make_pixel_map(const ProjectorMap& map, const PictureShape& picture);

/// Whether a mesh's cells, cut along the wall's creases, are large enough to be drawn quicker than a map of each pixel
/// is read.
[[nodiscard]] bool is_quicker_than_a_map(const WarpMesh& mesh);

/// Patches that keep to `tolerance_px`, if there are any; else a mesh that does, if it is_quicker_than_a_map(); else
/// that map. kInvalidArgument  the picture is none.
Result<Warp> make_warp(const ProjectorMap& map, const PictureShape& picture, double tolerance_px = 0.05);

/// Across the whole head, in projector pixels.
[[nodiscard]] int width_px(const Warp& warp);
[[nodiscard]] int height_px(const Warp& warp);
/// Nothing where nothing is drawn. Precondition: the pixel is inside the head.
[[nodiscard]] std::optional<PanoramaDirection> direction_at(const Warp& warp, int x, int y);

}  // namespace cyclorama::warp
