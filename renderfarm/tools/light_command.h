// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// `cyclorama-render light SCENE`: computes the light on the scene's surfaces and stores it with the scene.
[[nodiscard]] RenderCommand add_light_command(CLI::App* program);

}  // namespace cyclorama::tools
