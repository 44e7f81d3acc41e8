// SPDX-License-Identifier: Apache-2.0
/// An invisible mark in the pixels, different for each key, by which a leaked picture identifies the museum for which
/// it was made. It survives JPEG, cropping, downscaling to half, and the mean of frames of one view, also of three
/// museums' frames; but not the mean of frames of many views, nor an attacker who has the key.
///
/// Spread spectrum (Cox, Kilian, Leighton and Shamoon 1997, "Secure spread spectrum watermarking for multimedia"):
/// cells of 4 x 4 pixels are made lighter or darker by one code value, according to the key's random signs. Their
/// spatial frequency is lower than most that JPEG discards, and higher than most of a picture's content. The signs
/// repeat after 64 cells, so the position of a cropped picture is found by trying all offsets.
#pragma once

#include <cstdint>

#include "common/image/image.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {

inline constexpr int kWatermarkCellPx = 4;
inline constexpr int kWatermarkPeriodCells = 64;
/// Code values this close to black or white do not change: nothing is clipped, and the black around an exhibit, which
/// costs JPEG no bytes, stays black.
inline constexpr int kWatermarkMarginCodes = 8;

/// Strength of the mark. The farm uses the defaults; `cyclorama-bench-render watermark` measures the cost and effect of
/// others.
struct WatermarkStrength {
  int amplitude = 1;   ///< In code values, 1 to kWatermarkMarginCodes.
  int sparseness = 3;  ///< One cell in 2^sparseness is marked; 0 to 4.
};

/// One row of cells of a period: bit x is column x.
struct WatermarkRow {
  std::uint64_t marked = 0;
  std::uint64_t lighter = 0;  ///< Marked cells that become lighter; other marked cells become darker.
};
/// Returns row `row` of the pattern. Any number is valid, since rows repeat after kWatermarkPeriodCells. Reentrant.
[[nodiscard]] WatermarkRow watermark_row(std::uint64_t key, int row, int sparseness);

/// Marks the part `rect` of a picture. The mark depends only on the position in the whole picture, so the result is the
/// same to the last bit however the picture is cut. `key` 0 marks nothing. Precondition: `pixels` has the size of
/// `rect`, whose x and y are not negative. Reentrant.
void add_watermark(std::uint64_t key, const PixelRect& rect, RgbImage* pixels, const WatermarkStrength& strength = {});

}  // namespace cyclorama
