// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cyclorama {

/// Pictures are divided into blocks, tiles and parts only at multiples of this: a JPEG block with halved chroma is 16
/// pixels wide and must not cross a border.
inline constexpr int kCutPx = 16;

/// Returns the number of cells of kCutPx that cover `px` pixels.
[[nodiscard]] constexpr int cells_of_px(int px) { return (px + kCutPx - 1) / kCutPx; }

/// The cells of a picture that tiles have covered so far. A value; thread-bound.
class CoveredCells {
 public:
  CoveredCells() = default;
  CoveredCells(int width_px, int height_px)
      : columns_(static_cast<std::size_t>(cells_of_px(width_px))),
        covered_(columns_ * static_cast<std::size_t>(cells_of_px(height_px)), false) {}

  /// Covers the cells of a tile, whose corner is at a multiple of kCutPx. Returns false, and covers nothing, if the
  /// tile overlaps another one. Precondition: the tile lies inside the picture.
  bool cover(int x_px, int y_px, int width_px, int height_px) {
    if (!all(x_px, y_px, width_px, height_px, [](bool covered) { return !covered; })) return false;
    return all(x_px, y_px, width_px, height_px, [](std::vector<bool>::reference covered) { return covered = true; });
  }

  /// Number of all cells; covered() returns the number of covered cells.
  [[nodiscard]] std::size_t count() const { return covered_.size(); }
  [[nodiscard]] std::size_t covered() const {
    return static_cast<std::size_t>(std::count(covered_.begin(), covered_.end(), true));
  }

 private:
  bool all(int x_px, int y_px, int width_px, int height_px, const auto& is_fine) {
    for (int row = y_px / kCutPx; row < cells_of_px(y_px + height_px); ++row) {
      for (int column = x_px / kCutPx; column < cells_of_px(x_px + width_px); ++column) {
        if (!is_fine(covered_[static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column)]))
          return false;
      }
    }
    return true;
  }
  std::size_t columns_ = 0;
  std::vector<bool> covered_;
};

}  // namespace cyclorama
