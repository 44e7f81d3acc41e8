// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render trade SCENE --out DIR`: what each knob costs and gains, measured against a converged reference.
/// DIR then holds trade.csv, trade.svg, front.toml (for the governor), and the reference with the settings that it was
/// made with, which is used again as long as they and the
/// scene's files are the same.
[[nodiscard]] RenderCommand add_trade_command(CLI::App* program);

}  // namespace cyclorama
