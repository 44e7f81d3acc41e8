// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render denoise SCENE`: the denoiser's gain and error for several numbers of samples.
[[nodiscard]] tools::RenderCommand add_denoise_command(CLI::App* program);

}  // namespace cyclorama
