// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Figure 9 of the paper on which this project is based: frame rate against nodes, for scenes of several sizes.
tools::RenderCommand add_figure9_command(CLI::App* program);

}  // namespace cyclorama
