// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/shade_stages.h"

namespace cyclorama::render {

ShadeStage plain_stage(const SceneNeeds& needs) { return opaque_stage_with<false, false>(needs); }

}  // namespace cyclorama::render
