// SPDX-License-Identifier: Apache-2.0
#include "common/image/watermark.h"

#include <algorithm>
#include <vector>

#include "common/base/check.h"
#include "common/base/vector_clones.h"

namespace cyclorama {
namespace {

/// SplitMix64. Source: Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators", with Vigna's
/// constants.
std::uint64_t split_mix(std::uint64_t state) {
  state += 0x9e3779b97f4a7c15u;
  state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
  state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
  return state ^ (state >> 31);
}

/// Adds `delta` to values that are not near black or white. `delta` is in two's complement, so that sums of bytes
/// suffice.
CYCLORAMA_VECTOR_CLONES
void add_row(const std::uint8_t* delta, std::uint8_t* __restrict values, std::size_t count) {
  constexpr int kSpan = 255 - 2 * kWatermarkMarginCodes;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t value = values[i];
    // A mask instead of a branch, which gcc 12 would not vectorise.
    const std::uint8_t inside = static_cast<std::uint8_t>(value - kWatermarkMarginCodes) <= kSpan ? 0xff : 0;
    values[i] = static_cast<std::uint8_t>(value + (delta[i] & inside));
  }
}

}  // namespace

WatermarkRow watermark_row(std::uint64_t key, int row, int sparseness) {
  constexpr std::uint64_t kWordsPerRow = 8;
  const std::uint64_t first = static_cast<std::uint64_t>(row % kWatermarkPeriodCells) * kWordsPerRow;
  // Two rounds, so that keys that differ in few bits give unrelated rows.
  const std::uint64_t seed = split_mix(key);
  WatermarkRow out{~std::uint64_t{0}, split_mix(seed ^ split_mix(first))};
  for (int i = 1; i <= sparseness; ++i) {
    out.marked &= split_mix(seed ^ split_mix(first + static_cast<std::uint64_t>(i)));
  }
  return out;
}

void add_watermark(std::uint64_t key, const PixelRect& rect, RgbImage* pixels, const WatermarkStrength& strength) {
  CHECK(rect.x >= 0 && rect.y >= 0 && pixels->width() == rect.width && pixels->height() == rect.height);
  CHECK(strength.amplitude >= 1 && strength.amplitude <= kWatermarkMarginCodes && strength.sparseness >= 0 &&
        strength.sparseness <= 4);
  if (key == 0) return;
  std::vector<std::uint8_t> delta(pixels->row_values());
  int cell_row = -1;
  for (int y = 0; y < rect.height; ++y) {
    if (const int row = (rect.y + y) / kWatermarkCellPx; row != cell_row) {
      cell_row = row;
      const WatermarkRow cells = watermark_row(key, row, strength.sparseness);
      for (int x = 0; x < rect.width;) {
        const int column = (rect.x + x) / kWatermarkCellPx;
        const int bit = column % kWatermarkPeriodCells;
        const int sign = (cells.lighter >> bit & 1) != 0 ? 1 : -1;
        const int value = (cells.marked >> bit & 1) != 0 ? sign * strength.amplitude : 0;
        const int end = std::min(rect.width, (column + 1) * kWatermarkCellPx - rect.x);
        std::fill(delta.begin() + 3 * x, delta.begin() + 3 * end, static_cast<std::uint8_t>(value));
        x = end;
      }
    }
    add_row(delta.data(), pixels->at(0, y), delta.size());
  }
}

}  // namespace cyclorama
