// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// Keeps frame budgets with a governor on this machine alone, and measures the resulting pictures; then refines a
/// picture at rest and measures how its error falls.
tools::RenderCommand add_governed_command(CLI::App* program);

}  // namespace cyclorama
