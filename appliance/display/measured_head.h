// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/head_upload.h"
#include "common/room/installation.h"

namespace cyclorama::display {

/// What a projector needs whose warp another program measured: its file's warp, mask (alpha) and black level (beta).
///
/// A flat map's picture (2d, PFM, meshes) is the whole of `picture`; points in space that do not begin at the eye are
/// taken for the room's, seen from the sweet spot. Precondition: that projector has a warp.
/// kNotFound, kSystem, kBadData  the file, as its reader says.   kInvalidArgument  it has no such region, another size
/// than the projector, or says too little. All name projector, file, place and remedy.
Result<HeadPlan> measured_head(const Installation& installation, std::size_t projector, const PictureShape& picture);

}  // namespace cyclorama::display
