// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/node/block_renderer.h"

namespace cyclorama::node {

/// Returns a loader that reads scenes from disk and ray traces them with `threads` threads.
[[nodiscard]] SceneLoader embree_scene_loader(int threads);

}  // namespace cyclorama::node
