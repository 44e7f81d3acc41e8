// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/tools/render_command.h"

namespace cyclorama {

/// `cyclorama-bench-render watermark PICTURE`: cost and detection of the watermark on a picture, for each strength.
[[nodiscard]] tools::RenderCommand add_watermark_curve_command(CLI::App* program);

}  // namespace cyclorama
