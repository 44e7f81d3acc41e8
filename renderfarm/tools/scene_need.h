// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "renderfarm/render/requirements.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama {

/// Everything that a kernel can be compiled without, alone. describe() names it.
inline constexpr std::array<SceneNeeds, 6> kEachNeed = {{{.textures = true},
                                                         {.normal_maps = true},
                                                         {.surface = SurfaceLevel::kGlossy},
                                                         {.surface = SurfaceLevel::kLayered},
                                                         {.lights = true},
                                                         {.environment = true}}};
/// All of it: the general kernel.
inline constexpr SceneNeeds kEverything{true, true, SurfaceLevel::kLayered, true, true};

/// One thing that a scene may need, and whether this one does.
struct NamedNeed {
  std::string name;  ///< "textures"
  std::string what;  ///< "3, in 'wall', 'floor'"; empty: left out.
};

/// All of them, found or left out: from the materials of what is seen, the lights, and how the geometry is placed.
/// Looks at the alpha of every texel that blends. Reentrant.
[[nodiscard]] std::vector<NamedNeed> named_needs(const Scene& scene);

}  // namespace cyclorama
