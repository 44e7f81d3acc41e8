// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render light-bake SCENE`: what computing a scene's light costs, stage by stage, and how far
/// pictures that read it are from the truth.
[[nodiscard]] tools::RenderCommand add_light_bake_command(CLI::App* program);

}  // namespace cyclorama
