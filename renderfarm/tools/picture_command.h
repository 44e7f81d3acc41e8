// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama::tools {

/// Adds `cyclorama-render picture SCENE --out FILE`, which renders one picture into a PNG or PFM and prints its cost.
[[nodiscard]] RenderCommand add_picture_command(CLI::App* program);

}  // namespace cyclorama::tools
