// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render watermark PICTURE`: what the watermark costs and gives on a picture, strength by strength.
[[nodiscard]] RenderCommand add_watermark_curve_command(CLI::App* program);

}  // namespace cyclorama
