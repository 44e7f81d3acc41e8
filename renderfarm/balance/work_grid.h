// SPDX-License-Identifier: Apache-2.0
/// What each part of a picture cost, or is expected to cost, in cells of kCutPx: what the nodes time, and where the
/// balance cuts. Finer cells would say no more to a cut that cannot lie inside of them.
#pragma once

#include <span>
#include <vector>

#include "common/image/pixel_rect.h"

namespace cyclorama {

struct PictureSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

/// A block and what it cost: thread time in seconds.
struct MeasuredBlock {
  PixelRect rect;
  double cpu_seconds = 0.0;
  /// Of each kCutPx cell of the picture's grid that the rect touches, row by row; empty when the node did not tell.
  std::vector<float> cell_cpu_seconds{};
  double speed = 1.0;  ///< Of one thread of the node that rendered it.
};

/// A rectangle of cells; the last column and row of a picture may be narrower than the others.
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

/// Cells that cover `px` pixels; 0 for none.
[[nodiscard]] int cells_in(int px);
[[nodiscard]] PixelRect pixels_of(const CellRect& cells, PictureSize size);
/// All cells that the rect touches.
[[nodiscard]] CellRect cells_of(const PixelRect& rect);

/// Work of each cell of one picture, in seconds at speed 1: thread time times the node's speed. A value; reentrant.
class WorkGrid {
 public:
  WorkGrid() = default;
  /// All cells `work`. A picture without pixels has no cells.
  explicit WorkGrid(PictureSize size, float work = 0.0f);

  [[nodiscard]] PictureSize size() const { return size_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] CellRect whole() const { return {0, 0, columns_, rows_}; }
  [[nodiscard]] float& at(int x, int y) { return work_[index(x, y)]; }
  [[nodiscard]] float at(int x, int y) const { return work_[index(x, y)]; }
  [[nodiscard]] std::span<float> cells() { return work_; }  ///< Row by row.
  [[nodiscard]] std::span<const float> cells() const { return work_; }
  /// In pixels: what the last column and row are narrower by counts.
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

/// How a block's time is spread over its cells.
enum class CellTimes {
  kMeasured,  ///< By what the node told of each cell; where it told nothing, by `prior`, or evenly if that is null.
  kUniform,   ///< Evenly over its pixels, whatever the node told: the prediction binary tree's own rule.
};

/// What the blocks say of their cells; cells of which they say nothing are NaN. A block's cells sum up to what the
/// whole block took: what no cell accounts for (coding, say) is spread evenly. Blocks outside of the picture or off the
/// grid, and times that are no measurement (NaN, infinite, negative), are ignored. `prior` has the picture's size.
[[nodiscard]] WorkGrid work_of(PictureSize size, std::span<const MeasuredBlock> blocks, CellTimes times,
                               const WorkGrid* prior);

}  // namespace cyclorama
