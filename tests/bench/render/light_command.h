// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render light SCENE`: computes a scene's light and compares pictures that read it with denoised and
/// plain path tracing, from eyes that the light was not computed for.
[[nodiscard]] tools::RenderCommand add_light_command(CLI::App* program);

}  // namespace cyclorama
