// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "renderfarm/walkable/ground_search.h"

namespace cyclorama {

/// The ground from above, -z up, cropped to what was seen: walkable green, blocked red, steep orange, no ground blue,
/// not reached black; the outline white, holes yellow, what the scene says now in cyan, the start a cross, stops dots.
[[nodiscard]] RgbImage walkable_picture(const WalkableGround& ground, const SceneInfo& info);

}  // namespace cyclorama
