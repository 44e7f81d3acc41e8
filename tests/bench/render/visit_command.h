// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Measures the error of frames of a visit, from their views as a museum received them.
tools::RenderCommand add_visit_command(CLI::App* program);

}  // namespace cyclorama
