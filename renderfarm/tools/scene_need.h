// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "renderfarm/render/requirements.h"
#include "renderfarm/scene/scene.h"

namespace cyclorama::tools {

/// Every feature that a kernel can be compiled without, one at a time. describe() names it.
inline constexpr std::array<render::SceneNeeds, 6> kEachNeed = {{{.textures = true},
                                                                 {.normal_maps = true},
                                                                 {.surface = render::SurfaceLevel::kGlossy},
                                                                 {.surface = render::SurfaceLevel::kLayered},
                                                                 {.lights = true},
                                                                 {.environment = true}}};
/// All features: the general kernel.
inline constexpr render::SceneNeeds kEverything{true, true, render::SurfaceLevel::kLayered, true, true};

/// One feature and its use in a scene.
struct NamedNeed {
  std::string name;  ///< "textures"
  std::string what;  ///< "3, in 'wall', 'floor'"; empty if unused.
};

/// Returns all features, used or not, from the visible materials, the lights, and the placement of the geometry. Reads
/// the alpha of every texel that blends. Reentrant.
[[nodiscard]] std::vector<NamedNeed> named_needs(const scene::Scene& scene);

}  // namespace cyclorama::tools
