// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "common/image/pixel_rect.h"

namespace cyclorama {

/// Costs are recorded for squares of this side, on a grid that begins in the picture's corner. The ray tracer's cells
/// are the same squares, and no cut divides one.
inline constexpr int kCostCellPx = 16;

/// Returns the cells that the rectangle touches, as a rectangle in whole cells; empty for an empty rectangle.
/// Precondition: x and y are not negative.
[[nodiscard]] inline PixelRect cells_touched(const PixelRect& rect) {
  if (rect.empty()) return {};
  const int left = rect.x / kCostCellPx;
  const int top = rect.y / kCostCellPx;
  const int right = (rect.x + rect.width - 1) / kCostCellPx + 1;
  const int bottom = (rect.y + rect.height - 1) / kCostCellPx + 1;
  return {left, top, right - left, bottom - top};
}

/// Returns a cell's index in a list of `cells`, row by row. Precondition: the cell is in `cells`.
[[nodiscard]] inline std::size_t cell_index(const PixelRect& cells, int column, int row) {
  return static_cast<std::size_t>(row - cells.y) * static_cast<std::size_t>(cells.width) +
         static_cast<std::size_t>(column - cells.x);
}

}  // namespace cyclorama
