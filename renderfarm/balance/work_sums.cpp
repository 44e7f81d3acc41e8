// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/work_sums.h"

#include <cmath>

namespace cyclorama::balance {

WorkSums::WorkSums(const WorkGrid& work) : size_(work.size()), columns_(work.columns()), rows_(work.rows()) {
  sums_.resize(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1));
  for (int y = 0; y < rows_; ++y) {
    double row = 0.0;
    for (int x = 0; x < columns_; ++x) {
      const float cell = work.at(x, y);
      if (cell > 0.0f && std::isfinite(cell)) row += cell;
      sums_[index(x + 1, y + 1)] = sums_[index(x + 1, y)] + row;
    }
  }
}

int first_cut_with(const WorkSums& sums, const CellRect& r, CutDirection d, double work) {
  // The work before a cut is monotonic in the cut.
  int low = 1;
  int high = length_of(r, d) - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (sums.of(before_cut(r, d, middle)) < work) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

int nearest_cut(const WorkSums& sums, const CellRect& r, CutDirection d, double work) {
  const int cut = first_cut_with(sums, r, d, work);
  const auto miss = [&](int at) { return std::abs(sums.of(before_cut(r, d, at)) - work); };
  return cut > 1 && miss(cut - 1) < miss(cut) ? cut - 1 : cut;
}

}  // namespace cyclorama::balance
