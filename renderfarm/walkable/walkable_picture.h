// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "renderfarm/walkable/ground_search.h"

namespace cyclorama::walkable {

/// Draws the ground from above, -z up, cropped to the probed cells: walkable green, blocked red, steep orange, no
/// ground blue, not reached black; the outline white, holes yellow, the scene's current area cyan, the start a cross,
/// stops small crosses.
[[nodiscard]] RgbImage walkable_picture(const WalkableGround& ground, const scene::SceneInfo& info);

}  // namespace cyclorama::walkable
