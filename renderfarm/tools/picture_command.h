// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// `cyclorama-render picture SCENE --out FILE`: renders one picture into a PNG and prints its cost.
[[nodiscard]] RenderCommand add_picture_command(CLI::App* program);

}  // namespace cyclorama::tools
