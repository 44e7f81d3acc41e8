// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "renderfarm/node/block_renderer.h"
#include "renderfarm/render/crew.h"

namespace cyclorama::node {

/// Returns a loader that reads scenes from disk and ray traces them with these threads.
[[nodiscard]] SceneLoader embree_scene_loader(std::shared_ptr<render::Crew> crew);

}  // namespace cyclorama::node
