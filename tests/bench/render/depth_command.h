// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Measures what inverse depth adds to the frames of a scene: bytes beside the JPEG, and processor time.
tools::RenderCommand add_depth_command(CLI::App* program);

}  // namespace cyclorama
