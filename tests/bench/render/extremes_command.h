// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render extremes --out DIR`: renders and traces what lies at the ends of what can be asked for, in scenes
/// made in memory, and tells where it fails. DIR then holds extremes.csv and two plots. Fails if any case does.
[[nodiscard]] RenderCommand add_extremes_command(CLI::App* program);

}  // namespace cyclorama
