// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// `cyclorama-render inspect SCENE`: the content of a scene, and its kernel.
[[nodiscard]] RenderCommand add_inspect_command(CLI::App* program);

}  // namespace cyclorama::tools
