// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render vitrine`: how much darker an object behind plates of glass is than many paths that refract
/// in the glass show it.
[[nodiscard]] tools::RenderCommand add_vitrine_command(CLI::App* program);

}  // namespace cyclorama
