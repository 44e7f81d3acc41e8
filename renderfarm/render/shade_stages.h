// SPDX-License-Identifier: Apache-2.0
/// All shading stages. Included by the shade_*.cpp files; each instantiates some of them, so that they compile in
/// parallel.
///
/// For matte and glossy surfaces there is one stage for each combination of textures, normal maps, lights and
/// environment. Layered surfaces (glass, lacquer) are rare and expensive anyway, so their stages differ by textures and
/// normal maps only.
#pragma once

#include <utility>

#include "renderfarm/render/shade.h"

namespace cyclorama::render {

/// Returns the stage for opaque surfaces, given its textures and normal maps.
template <bool kTextures, bool kNormalMaps>
[[nodiscard]] ShadeStage opaque_stage_with(const SceneNeeds& needs) {
  constexpr auto kMake = []<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
    return std::array<ShadeStage, sizeof...(kIndex)>{
        &shade<SceneNeeds{kTextures, kNormalMaps, (kIndex & 1) != 0 ? SurfaceLevel::kGlossy : SurfaceLevel::kMatte,
                          (kIndex & 2) != 0, (kIndex & 4) != 0}>...};
  };
  constexpr std::array<ShadeStage, 8> kStages = kMake(std::make_index_sequence<8>());
  return kStages[static_cast<std::size_t>((needs.surface == SurfaceLevel::kGlossy ? 1 : 0) | (needs.lights ? 2 : 0) |
                                          (needs.environment ? 4 : 0))];
}

// Opaque surfaces.
[[nodiscard]] ShadeStage plain_stage(const SceneNeeds& needs);
[[nodiscard]] ShadeStage textured_stage(const SceneNeeds& needs);
[[nodiscard]] ShadeStage normal_mapped_stage(const SceneNeeds& needs);
// All surfaces.
[[nodiscard]] ShadeStage layered_stage(const SceneNeeds& needs);

}  // namespace cyclorama::render
