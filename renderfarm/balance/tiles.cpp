// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/tiles.h"

#include <algorithm>

namespace cyclorama::balance {
namespace {

/// Returns the cuts of a side, from 0 to `length_px`.
std::vector<int> cuts_of(int length_px) {
  const int cells = (length_px + kCutPx - 1) / kCutPx;
  constexpr int kMaxTileCells = kMaxTilePx / kCutPx;
  const int parts = (cells + kMaxTileCells - 1) / kMaxTileCells;
  std::vector<int> cuts;
  for (int i = 0; i <= parts; ++i) cuts.push_back(std::min(length_px, cells * i / parts * kCutPx));
  return cuts;
}

}  // namespace

std::vector<PixelRect> tiles_of(const PixelRect& block) {
  std::vector<PixelRect> tiles;
  if (block.empty()) return tiles;
  const std::vector<int> xs = cuts_of(block.width);
  const std::vector<int> ys = cuts_of(block.height);
  for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
    for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
      tiles.push_back({block.x + xs[i], block.y + ys[j], xs[i + 1] - xs[i], ys[j + 1] - ys[j]});
    }
  }
  return tiles;
}

}  // namespace cyclorama::balance
