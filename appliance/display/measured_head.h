// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/head_upload.h"
#include "common/room/installation.h"

namespace cyclorama::display {

/// Returns the plan of a projector whose warp another program measured, with the warp, mask (alpha) and black level
/// (beta) of that program's file.
///
/// A flat map (2d, PFM, meshes) covers the whole of `picture`. Points in space that are not relative to the eye are
/// taken as points of the room, seen from the sweet spot. Precondition: the projector has a warp file.
/// Errors: kNotFound, kSystem and kBadData for the reasons of the file's reader; kInvalidArgument if the file has no
/// such region, has another size than the projector, or is incomplete. Every message names projector, file, location
/// and remedy.
Result<HeadPlan> measured_head(const Installation& installation, std::size_t projector, const PictureShape& picture);

}  // namespace cyclorama::display
