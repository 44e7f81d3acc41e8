// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render features SCENE...`: the saving of each scene's specialised kernel.
[[nodiscard]] tools::RenderCommand add_features_command(CLI::App* program);

}  // namespace cyclorama
