// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// Adds `cyclorama-render inspect SCENE`, which prints the content of a scene and its kernel.
[[nodiscard]] RenderCommand add_inspect_command(CLI::App* program);

}  // namespace cyclorama::tools
