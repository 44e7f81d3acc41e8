// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "renderfarm/light_baking/bake_light.h"
#include "renderfarm/light_baking/stage_chain.h"

namespace cyclorama::light_baking {

/// Computes the light of one group of lamps (renderfarm/scene/lamp_groups.h), with the threads of the TBB arena in
/// which it is called. The renderer must have no light; afterwards it may have that of the group. Errors: those of
/// bake_light().
Result<BakedLight> bake_group(render::Renderer& renderer, const BakeSettings& settings, std::size_t group,
                              const std::function<void(double)>& progress, const std::function<bool()>& cancelled,
                              StageChain& stages);

}  // namespace cyclorama::light_baking
