// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/head_upload.h"
#include "common/room/installation.h"

namespace cyclorama::display {

/// Returns the head of a projector whose warp another program measured: its file's warp, mask (alpha) and black level
/// (beta).
///
/// The picture of a flat map (2d, PFM, meshes) is the whole of `picture`. Points in space that do not begin at the eye
/// are taken as points of the room, seen from the sweet spot. Precondition: that projector has a warp.
/// Errors: kNotFound, kSystem, kBadData of the file's reader; kInvalidArgument if the file has no such region, has
/// another size than the projector, or contains too little. All name projector, file, location and remedy.
Result<HeadPlan> measured_head(const Installation& installation, std::size_t projector, const PictureShape& picture);

}  // namespace cyclorama::display
