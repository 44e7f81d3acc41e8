// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// Adds `cyclorama-render load SCENE`, which prints the time and memory of loading and of the BVH.
[[nodiscard]] RenderCommand add_load_command(CLI::App* program);

}  // namespace cyclorama::tools
