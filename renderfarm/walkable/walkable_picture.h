// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "renderfarm/walkable/ground_search.h"

namespace cyclorama::walkable {

/// Draws the ground from above, with -z up, cropped to the probed cells. Walkable cells are green, blocked ones red,
/// steep ones orange, cells without ground blue, and cells that were not reached black. The outline is white, holes are
/// yellow, and the scene's current area is cyan. The start is a cross, and tour stops are small crosses.
[[nodiscard]] RgbImage walkable_picture(const WalkableGround& ground, const scene::SceneInfo& info);

}  // namespace cyclorama::walkable
