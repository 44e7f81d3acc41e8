// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render jpeg PICTURE`: bytes, time and error of a picture as JPEG, by quality, chroma and tile size.
[[nodiscard]] tools::RenderCommand add_jpeg_command(CLI::App* program);

}  // namespace cyclorama
