// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Shares out the frames of records among simulated nodes by every strategy, each of which sees the frame before.
RenderCommand add_replay_command(CLI::App* program);

}  // namespace cyclorama
