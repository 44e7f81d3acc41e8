// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/shade_stages.h"

namespace cyclorama::render {

ShadeStage normal_mapped_stage(const SceneNeeds& needs) { return opaque_stage_with<true, true>(needs); }

}  // namespace cyclorama::render
