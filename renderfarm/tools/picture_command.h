// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-render picture SCENE --out FILE`: one picture into a PNG, and what it cost.
[[nodiscard]] RenderCommand add_picture_command(CLI::App* program);

}  // namespace cyclorama
