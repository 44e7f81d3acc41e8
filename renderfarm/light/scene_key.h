// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/light/light_store.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::light {

/// Returns the hash (XXH3, 128 bits) of everything in a scene on which its light depends. Omits names, the tour and the
/// exposure, which do not affect surfaces. Reads all geometry and textures, at several gigabytes per second. Reentrant.
[[nodiscard]] SceneKey key_of(const scene::Scene& scene);

}  // namespace cyclorama::light
