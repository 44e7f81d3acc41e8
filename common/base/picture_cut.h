// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cyclorama {

/// Pictures are cut into blocks, tiles and parts at multiples of this only: a JPEG block with halved chroma is 16
/// pixels wide, and must not straddle.
inline constexpr int kCutPx = 16;

/// Cells of kCutPx that cover so many pixels.
[[nodiscard]] constexpr int cells_of_px(int px) { return (px + kCutPx - 1) / kCutPx; }

/// Which cells of a picture tiles have covered. A value; thread-bound.
class CoveredCells {
 public:
  CoveredCells() = default;
  CoveredCells(int width_px, int height_px)
      : columns_(static_cast<std::size_t>(cells_of_px(width_px))),
        covered_(columns_ * static_cast<std::size_t>(cells_of_px(height_px)), false) {}

  /// The cells of a tile; its corner lies on a cut. False, and no more is covered, if it lies over another.
  /// Precondition: it lies inside of the picture.
  bool cover(int x_px, int y_px, int width_px, int height_px) {
    if (!all(x_px, y_px, width_px, height_px, [](bool covered) { return !covered; })) return false;
    return all(x_px, y_px, width_px, height_px, [](std::vector<bool>::reference covered) { return covered = true; });
  }

  /// Of all cells, and of those that are covered.
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
