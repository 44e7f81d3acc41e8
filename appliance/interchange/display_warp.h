// SPDX-License-Identifier: Apache-2.0
/// Converts regions of other programs to warps of a display (appliance/warp), and these warps to regions for other
/// programs. Pure; reentrant.
///
///     region (2d)       u, v in the source picture ─ picture's shape ─┐
///     region (3d)       u, v in a frustum's view ─────────────────────┼─▶ directions from the sweet spot ─▶ Warp
///     region (a3, sl)   x, y, z on the screen ─ position of the eye ──┘
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

/// Parameters that may be missing in a file.
struct WarpSetting {
  /// For 2d: shape of the buffer's whole picture.
  PictureShape picture = Panorama{};
  /// For a3 and sl: the sweet spot in the map's frame, in metres. Not needed if the origin of the data is the ideal eye
  /// point.
  std::optional<Eigen::Vector3d> eye_m;
};

/// Unit vectors in the Eye frame (x right, y up, -z the heading), one per sample of the region's map; NaN where nothing
/// is mapped or visible.
using DirectionMap = Image<float, 3>;

/// Returns the directions of a region's samples. Errors: kInvalidArgument if there is no map, frustum (3d), unit or
/// eye's position (a3, sl), with the remedy; kBadData if no sample gives a direction.
Result<DirectionMap> directions_of(const WarpRegion& region, WarpProfile profile, const WarpSetting& setting);

/// Returns a mesh over the projector's picture with positions in `picture`. The cells are halved until the error is at
/// most `tolerance_px` and no mapped sample is left out, or until they are four pixels wide. Vertices just outside the
/// mapped area are extrapolated, so that the rim is drawn; mask_of() cuts it off pixel by pixel.
/// WarpMesh::worst_error_px is the remaining error; infinite if a mapped sample is left out. Errors: kBadData if
/// nothing is mapped, or nothing mapped is in the picture.
Result<warp::WarpMesh> mesh_from(const DirectionMap& directions, int width_px, int height_px,
                                 const PictureShape& picture, double tolerance_px);

/// Returns the result of mesh_from() if its error is at most `tolerance_px` and is_quicker_than_a_map(); else a map of
/// the pixels' centres, interpolated between the samples. Errors: those of mesh_from().
Result<warp::Warp> warp_from(const DirectionMap& directions, int width_px, int height_px, const PictureShape& picture,
                             double tolerance_px = 0.05);

/// Returns factors on linear light per projector pixel: alpha (mean of its channels), and 0 where nothing is mapped.
[[nodiscard]] warp::MaskImage mask_of(const WarpRegion& region);
/// Returns the linear light that each pixel adds so that black is uniform (beta); empty if the region has no beta map.
[[nodiscard]] std::optional<warp::MaskImage> black_level_of(const WarpRegion& region);

/// Returns a warp as a 2d region over the whole of `picture`: u, v at each pixel's centre, NaN where the mesh is not
/// drawn or is outside the picture; the mask becomes the alpha in 16 bits. Precondition: the mask has the mesh's size
/// in pixels.
[[nodiscard]] WarpRegion region_of(const warp::WarpMesh& mesh, const warp::MaskImage& mask, const PictureShape& picture,
                                   const std::string& id);

/// Returns a warp as points on the wall, in metres from `eye` (a3). Such points are valid for any eye, so that other
/// engines can track a viewer.
[[nodiscard]] WarpRegion region_in_space(const warp::ProjectorMap& map, const Point<frame::Room>& eye,
                                         const warp::MaskImage& mask, const std::string& id);

/// Returns all projectors of an installation as an a3 set: region_in_space() of each with their common blend, in one
/// buffer with the installation's name. Regions have the projectors' names.
[[nodiscard]] WarpSet set_of(const Installation& installation);

}  // namespace cyclorama::interchange
