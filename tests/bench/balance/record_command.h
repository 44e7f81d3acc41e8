// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Renders a path through a scene on this machine and records the cost of each cell.
tools::RenderCommand add_record_command(CLI::App* program);

}  // namespace cyclorama
