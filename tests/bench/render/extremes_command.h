// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render extremes --out DIR`: renders and traces extreme scenes, made in memory, and reports
/// failures. Writes extremes.csv and two plots to DIR. Fails if any case does.
[[nodiscard]] tools::RenderCommand add_extremes_command(CLI::App* program);

}  // namespace cyclorama
