// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/image/watermark_detector.h"
#include "renderfarm/tools/render_command.h"
#include "renderfarm/trust/grants.h"

namespace cyclorama::tools {

struct WatermarkVerdict {
  std::string museum;
  WatermarkFind find;
  int cell_px = kWatermarkCellPx;  ///< Half of kWatermarkCellPx if the picture was scaled down to half.
};

/// Returns the best score of every museum that has a key, highest first, over all offsets, in full and in half size.
/// Reentrant.
std::vector<WatermarkVerdict> find_museum(const RgbImage& picture, const trust::Grants& grants);

/// Adds `cyclorama-render watermark PICTURE --museums FILE`, which finds the museum for which a picture was made.
[[nodiscard]] RenderCommand add_watermark_command(CLI::App* program);

}  // namespace cyclorama::tools
