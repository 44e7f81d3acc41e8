// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "renderfarm/scene/scene.h"

namespace cyclorama::tools {

/// One feature and its use in a scene.
struct NamedNeed {
  std::string name;  ///< Such as "textures".
  std::string what;  ///< Such as "3, in 'wall', 'floor'"; empty if unused.
};

/// Returns all features, used or not, from the visible materials, the lights, and the placement of the geometry. Reads
/// the alpha of every texel that blends. Reentrant.
[[nodiscard]] std::vector<NamedNeed> named_needs(const scene::Scene& scene);

}  // namespace cyclorama::tools
