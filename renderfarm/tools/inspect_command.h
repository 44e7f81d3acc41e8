// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-render inspect SCENE`: what a scene holds, and which kernel it gets.
[[nodiscard]] RenderCommand add_inspect_command(CLI::App* program);

}  // namespace cyclorama
