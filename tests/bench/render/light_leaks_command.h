// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render light-leaks`: scenes with bright beside dark and thin things between; counts the blocks of
/// 8x8 pixels that differ from path tracing by more than 4 codes.
[[nodiscard]] tools::RenderCommand add_light_leaks_command(CLI::App* program);

}  // namespace cyclorama
