// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/shade_stages.h"

namespace cyclorama::render {

ShadeStage layered_stage(const SceneNeeds& needs) {
  if (needs.normal_maps) return &shade<SceneNeeds{true, true, SurfaceLevel::kLayered, true, true}>;
  if (needs.textures) return &shade<SceneNeeds{true, false, SurfaceLevel::kLayered, true, true}>;
  return &shade<SceneNeeds{false, false, SurfaceLevel::kLayered, true, true}>;
}

}  // namespace cyclorama::render
