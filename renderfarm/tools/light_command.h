// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// Adds `cyclorama-render light SCENE`, which computes the light on a scene's surfaces and stores it with the scene.
[[nodiscard]] RenderCommand add_light_command(CLI::App* program);

}  // namespace cyclorama::tools
