// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "renderfarm/balance/work_grid.h"

namespace cyclorama::balance {

/// A summed-area table, which yields the work of any rectangle of cells in four look-ups. A value; reentrant.
class WorkSums {
 public:
  /// Computes the sums. Cells that are NaN, infinite or negative count as 0.
  explicit WorkSums(const WorkGrid& work);

  [[nodiscard]] PictureSize size() const { return size_; }
  [[nodiscard]] CellRect whole() const { return {0, 0, columns_, rows_}; }
  /// Returns the work of a rectangle. Precondition: `r` is inside the picture.
  [[nodiscard]] double of(const CellRect& r) const {
    // Rounding may yield a value below 0 for cells without work.
    const double sum =
        up_to(r.x + r.width, r.y + r.height) - up_to(r.x, r.y + r.height) - up_to(r.x + r.width, r.y) + up_to(r.x, r.y);
    return sum > 0.0 ? sum : 0.0;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_ + 1) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] double up_to(int x, int y) const { return sums_[index(x, y)]; }

  PictureSize size_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<double> sums_;  ///< Sums of all cells above and to the left; one row and column more than cells.
};

enum class CutDirection : unsigned char { kAcross, kDown };

[[nodiscard]] constexpr int length_of(const CellRect& r, CutDirection d) {
  return d == CutDirection::kAcross ? r.width : r.height;
}
[[nodiscard]] constexpr CutDirection longer_side(const CellRect& r) {
  return r.width >= r.height ? CutDirection::kAcross : CutDirection::kDown;
}
/// Return the first `cut` columns or rows, and the remaining ones.
[[nodiscard]] constexpr CellRect before_cut(CellRect r, CutDirection d, int cut) {
  (d == CutDirection::kAcross ? r.width : r.height) = cut;
  return r;
}
[[nodiscard]] constexpr CellRect after_cut(CellRect r, CutDirection d, int cut) {
  (d == CutDirection::kAcross ? r.x : r.y) += cut;
  (d == CutDirection::kAcross ? r.width : r.height) -= cut;
  return r;
}

/// Returns the smallest cut in [1, length - 1] with at least `work` before it; length - 1 if there is none.
/// Precondition: the length is at least 2.
[[nodiscard]] int first_cut_with(const WorkSums& sums, const CellRect& r, CutDirection d, double work);
/// Returns the cut in [1, length - 1] for which the work before it is closest to `work`. Precondition: the length is at
/// least 2.
[[nodiscard]] int nearest_cut(const WorkSums& sums, const CellRect& r, CutDirection d, double work);

}  // namespace cyclorama::balance
