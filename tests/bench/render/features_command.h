// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render features SCENE...`: what each scene saves by a kernel that is compiled without what it does not
/// need.
[[nodiscard]] RenderCommand add_features_command(CLI::App* program);

}  // namespace cyclorama
