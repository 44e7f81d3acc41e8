// SPDX-License-Identifier: Apache-2.0
/// From a region that others measured to what a display draws (appliance/warp), and from our own warp to a region that
/// others play. Pure; reentrant.
///
///     region (2d)       u, v in the source picture ─ picture's shape ─┐
///     region (3d)       u, v in a frustum's view ─────────────────────┼─▶ directions from the sweet spot ─▶ Warp
///     region (a3, sl)   x, y, z on the screen ─ where the eye is ─────┘
///     alpha ────────────────────────────────────────────────────────────▶ MaskImage      beta ─▶ black level
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "appliance/interchange/warp_set.h"
#include "appliance/warp/blend_mask.h"
#include "appliance/warp/pixel_map.h"
#include "common/geometry/projection.h"

namespace cyclorama::interchange {

/// What a file does not say, and we know.
struct WarpSetting {
  /// 2d: what the whole picture of the region's buffer shows.
  PictureShape picture = Panorama{};
  /// a3 and sl: the sweet spot in the map's frame, metres. Not needed where the data begin at the ideal eye point.
  std::optional<Eigen::Vector3d> eye_m;
};

/// Unit vectors in the Eye frame (x right, y up, -z the heading), one per sample of the region's map; NaN where nothing
/// is mapped or seen.
using DirectionMap = Image<float, 3>;

/// kInvalidArgument  the region has no map, no frustum (3d), no unit or no place of the eye (a3, sl): says what to
/// give. kBadData  no sample gives a direction.
Result<DirectionMap> directions_of(const WarpRegion& region, WarpProfile profile, const WarpSetting& setting);

/// A mesh over the projector's picture that says where in `picture` its pixels lie, whose cells are halved until they
/// keep to `tolerance_px` of the directions and no mapped sample is left out, or are four pixels wide. Vertices just
/// outside of what is mapped go on straight, so that the rim is drawn: mask_of() cuts it off pixel by pixel.
/// WarpMesh::worst_error_px is what is left; infinite where a mapped sample is left out.
/// kBadData  nothing mapped, or nothing of it is in the picture's reach.
Result<warp::WarpMesh> mesh_from(const DirectionMap& directions, int width_px, int height_px,
                                 const PictureShape& picture, double tolerance_px);

/// That mesh, if it keeps to `tolerance_px` and is_quicker_than_a_map(); else where each pixel's centre lies, between
/// the samples. Errors of mesh_from().
Result<warp::Warp> warp_from(const DirectionMap& directions, int width_px, int height_px, const PictureShape& picture,
                             double tolerance_px = 0.05);

/// Factors on linear light per projector pixel: alpha (its channels' mean), and 0 where nothing is mapped.
[[nodiscard]] warp::MaskImage mask_of(const WarpRegion& region);
/// The linear light that every pixel shows at least (black level); nothing where the region has no beta.
[[nodiscard]] std::optional<warp::MaskImage> black_level_of(const WarpRegion& region);

/// Our warp as a 2d region over the whole of `picture`: u, v at each pixel's centre, NaN where the mesh is not drawn or
/// leaves the picture, and the mask as alpha in 16 bits. Precondition: the mask has the mesh's pixels.
[[nodiscard]] WarpRegion region_of(const warp::WarpMesh& mesh, const warp::MaskImage& mask, const PictureShape& picture,
                                   const std::string& id);

/// The same as points on the wall, in metres from the eye (a3): right from any place, so other engines can follow an
/// eye.
[[nodiscard]] WarpRegion region_in_space(const warp::ProjectorMap& map, const Point<frame::Room>& eye,
                                         const warp::MaskImage& mask, const std::string& id);

/// All of a room's projectors as MPCDI a3: what region_in_space() says of each, with the blend of them all, in one
/// buffer that is named as the installation; regions are named as the projectors.
[[nodiscard]] WarpSet set_of(const Installation& installation);

}  // namespace cyclorama::interchange
