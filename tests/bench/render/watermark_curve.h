// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/base/result.h"
#include "common/image/watermark.h"

namespace cyclorama {

inline constexpr std::array kWatermarkQualities{95, 85, 75, 50};

/// Cost of a watermark's strength, and reliability of its detection.
struct WatermarkPoint {
  WatermarkStrength strength;
  double grey_psnr_db = 0.0;  ///< On flat grey, where every change is visible.
  double grey_flip = 0.0;
  double flip = 0.0;        ///< On the picture.
  double more_bytes = 0.0;  ///< Relative increase in bytes, in JPEG of quality 85, 4:2:0.
  double ms_per_megapixel = 0.0;
  std::array<double, kWatermarkQualities.size()> scores{};  ///< After JPEG 4:2:0 of these qualities.
  double half_score = 0.0;                                  ///< At half the size, after JPEG of quality 85.
};

/// Measures every strength. Errors: kInvalidArgument for a picture of less than 64 pixels a side.
Result<std::vector<WatermarkPoint>> measure_watermark(const RgbImage& picture);

}  // namespace cyclorama
