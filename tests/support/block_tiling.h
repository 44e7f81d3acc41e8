// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "renderfarm/balance/balancer.h"
#include "renderfarm/balance/tiles.h"

namespace cyclorama {

/// Checks all guarantees of Balancer::split(): the blocks tile the picture on the grid, in the order of the nodes, and
/// the stealable blocks of each node come last.
inline testing::AssertionResult is_whole_plan(balance::PictureSize size, std::size_t nodes,
                                              const std::vector<balance::PlannedBlock>& plan) {
  balance::WorkGrid taken(size);
  std::int64_t area = 0;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const PixelRect& b = plan[i].rect;
    const int right = b.x + b.width;
    const int bottom = b.y + b.height;
    if (b.empty()) return testing::AssertionFailure() << "block " << i << " is empty";
    if (plan[i].node >= nodes) return testing::AssertionFailure() << "block " << i << " is of no node";
    if (!(plan[i].predicted_seconds >= 0.0)) return testing::AssertionFailure() << "block " << i << " costs no number";
    if (i > 0 && plan[i].node < plan[i - 1].node) return testing::AssertionFailure() << "nodes out of order";
    if (i > 0 && plan[i].node == plan[i - 1].node && plan[i - 1].stealable && !plan[i].stealable) {
      return testing::AssertionFailure() << "block " << i << " is not stealable and comes after one that is";
    }
    if (b.x < 0 || b.y < 0 || right > size.width || bottom > size.height) {
      return testing::AssertionFailure() << "block " << i << " is outside";
    }
    if (b.x % kCutPx != 0 || b.y % kCutPx != 0 || (right % kCutPx != 0 && right != size.width) ||
        (bottom % kCutPx != 0 && bottom != size.height)) {
      return testing::AssertionFailure() << "block " << i << " is off the grid";
    }
    area += b.area();
    const balance::CellRect cells = balance::cells_of(b);
    for (int y = cells.y; y < cells.y + cells.height; ++y) {
      for (int x = cells.x; x < cells.x + cells.width; ++x) {
        if (taken.at(x, y)++ > 0.0f) return testing::AssertionFailure() << "overlap at cell " << x << ", " << y;
      }
    }
  }
  if (area != std::int64_t{size.width} * size.height) return testing::AssertionFailure() << "a hole";
  return testing::AssertionSuccess();
}

}  // namespace cyclorama
