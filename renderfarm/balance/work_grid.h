// SPDX-License-Identifier: Apache-2.0
/// Measured or expected cost of the parts of a picture, in cells of kCutPx pixels. Nodes measure and the balancer cuts
/// in these cells. Finer cells would not help, because no cut is inside a cell.
#pragma once

#include <span>
#include <vector>

#include "common/image/pixel_rect.h"

namespace cyclorama::balance {

struct PictureSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

/// A block and its cost as thread time in seconds.
struct MeasuredBlock {
  PixelRect rect;
  double cpu_seconds = 0.0;
  /// Cost of each cell of the picture's grid that the rect touches, row by row; empty if the node did not report it.
  std::vector<float> cell_cpu_seconds{};
  double speed = 1.0;  ///< Speed of one thread of the node that rendered it.
};

/// A rectangle of cells. The last column and row of a picture may be narrower than the others.
struct CellRect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
  [[nodiscard]] std::size_t count() const {
    return empty() ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  friend bool operator==(const CellRect&, const CellRect&) = default;
};

/// Returns the number of cells that cover `px` pixels; 0 if there are none.
[[nodiscard]] int cells_in(int px);
[[nodiscard]] PixelRect pixels_of(const CellRect& cells, PictureSize size);
/// Returns all cells that the rect touches.
[[nodiscard]] CellRect cells_of(const PixelRect& rect);

/// Work of each cell of one picture, in seconds at speed 1: thread time times the node's speed. A value; reentrant.
class WorkGrid {
 public:
  WorkGrid() = default;
  /// Sets all cells to `work`. A picture without pixels has no cells.
  explicit WorkGrid(PictureSize size, float work = 0.0f);

  [[nodiscard]] PictureSize size() const { return size_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] CellRect whole() const { return {0, 0, columns_, rows_}; }
  [[nodiscard]] float& at(int x, int y) { return work_[index(x, y)]; }
  [[nodiscard]] float at(int x, int y) const { return work_[index(x, y)]; }
  [[nodiscard]] std::span<float> cells() { return work_; }  ///< Cells row by row.
  [[nodiscard]] std::span<const float> cells() const { return work_; }
  /// Return the size of a column or row in pixels; the last one may be narrower than the others.
  [[nodiscard]] int width_px(int x) const;
  [[nodiscard]] int height_px(int y) const;
  [[nodiscard]] double total() const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  PictureSize size_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> work_;
};

/// Distribution of a block's time over its cells:
enum class CellTimes {
  /// Times from the node's report. If there is none, the block's time is shared in proportion to `prior`, or to area if
  /// that is null.
  kMeasured,
  kUniform,  ///< Evenly over the pixels, whatever the node reported; the rule of the prediction binary tree.
};

/// Returns the work of each measured cell; other cells are NaN. The cells of a block add up to the time of the whole
/// block: time that the cells do not account for (such as coding) is distributed evenly. Blocks outside the picture or
/// off the grid, and invalid times (NaN, infinite, negative), are ignored. Precondition: `prior` is null or has the
/// picture's size.
[[nodiscard]] WorkGrid work_of(PictureSize size, std::span<const MeasuredBlock> blocks, CellTimes times,
                               const WorkGrid* prior);

}  // namespace cyclorama::balance
