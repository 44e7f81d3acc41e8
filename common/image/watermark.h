// SPDX-License-Identifier: Apache-2.0
/// An invisible mark in the pixels, other for each key, by which a picture that got out tells which museum it was made
/// for. It outlives JPEG, cropping, and downscaling to half; not averaging over many frames, nor somebody who knows
/// the key.
///
/// Spread spectrum (Cox, Kilian, Leighton and Shamoon 1997, "Secure spread spectrum watermarking for multimedia"):
/// cells of 4 x 4 pixels are made lighter or darker by one code value, as the key's random signs say. That is lower
/// than most that JPEG throws away, and higher than most of what a picture shows. The signs repeat after 64 cells, so
/// a cut-out finds its place by trying them all.
#pragma once

#include <cstdint>

#include "common/image/image.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {

inline constexpr int kWatermarkCellPx = 4;
inline constexpr int kWatermarkPeriodCells = 64;
/// Code values this near to black and white stay as they are: nothing is clipped, and the void around a relic, which
/// JPEG codes in no bytes, stays void.
inline constexpr int kWatermarkMarginCodes = 8;

/// The standard is what the farm uses; `cyclorama-bench-render watermark` measures what others cost and give.
struct WatermarkStrength {
  int amplitude = 1;   ///< Code values, 1 to kWatermarkMarginCodes.
  int sparseness = 3;  ///< One cell in two to the power of it is marked, 0 to 4.
};

/// A row of cells of one period: bit x is column x.
struct WatermarkRow {
  std::uint64_t marked = 0;
  std::uint64_t lighter = 0;  ///< Of the marked ones; the others are darker.
};
/// Any `row`; it repeats after kWatermarkPeriodCells. Reentrant.
[[nodiscard]] WatermarkRow watermark_row(std::uint64_t key, int row, int sparseness);

/// Marks the part `rect` of a picture. The mark goes by the place in the whole picture, so however the picture is cut,
/// it becomes the same to the last bit. `key` 0: nothing is done. Precondition: the pixels have the size of `rect`,
/// which begins at or beyond (0, 0). Reentrant.
void add_watermark(std::uint64_t key, const PixelRect& rect, RgbImage* pixels, const WatermarkStrength& strength = {});

}  // namespace cyclorama
