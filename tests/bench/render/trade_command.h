// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render trade SCENE --out DIR`: cost and gain of each setting, measured against a converged
/// reference. Writes trade.csv, trade.svg, pareto_front.toml (for the governor), and the reference with the settings
/// that produced it; the reference is reused while these and the scene's files are unchanged.
[[nodiscard]] tools::RenderCommand add_trade_command(CLI::App* program);

}  // namespace cyclorama
