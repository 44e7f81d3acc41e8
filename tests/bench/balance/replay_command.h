// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Divides the frames of records among simulated nodes by every strategy; each strategy sees the previous frame.
tools::RenderCommand add_replay_command(CLI::App* program);

}  // namespace cyclorama
