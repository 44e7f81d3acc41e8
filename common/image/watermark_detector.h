// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/image/image.h"
#include "common/image/watermark.h"

namespace cyclorama {

/// Evidence that a picture has a key's mark: the correlation with the key's signs, divided by its standard deviation.
/// For a key that was not used in the picture, it is normally distributed with deviation 1, whatever the picture shows.
struct WatermarkFind {
  double score = 0.0;
  int x_px = 0;  ///< Position of the picture's upper left corner within a period; 0 if the picture was not cropped.
  int y_px = 0;
};

/// Score from which a mark counts as certain: in all but one of a million unmarked pictures, it exceeds the maximum
/// over 2^16 positions and a few hundred keys.
inline constexpr double kWatermarkCertain = 8.0;

/// Searches one picture for many keys. Thread-bound.
class WatermarkDetector {
 public:
  /// `cell_px` is the size of a cell in this picture: kWatermarkCellPx unless it was scaled; 1 to 8.
  explicit WatermarkDetector(const RgbImage& picture, int cell_px = kWatermarkCellPx,
                             int sparseness = WatermarkStrength{}.sparseness);

  /// Returns the score at position 0, for a picture that was not cropped.
  [[nodiscard]] double score(std::uint64_t key) const;
  /// Returns the best of all 2^16 positions, of which one reaches about 4.5 by chance. Takes tenths of a second.
  [[nodiscard]] WatermarkFind search(std::uint64_t key) const;

 private:
  static constexpr int kPeriod = kWatermarkPeriodCells;
  /// Difference of each cell of the period from its neighbours, summed over all periods of the picture.
  using Fold = std::array<float, static_cast<std::size_t>(kPeriod) * kPeriod>;
  [[nodiscard]] const Fold& fold_at(int x, int y) const {
    return folds_[static_cast<std::size_t>(y) * static_cast<std::size_t>(cell_px_) + static_cast<std::size_t>(x)];
  }

  int cell_px_;
  int sparseness_;
  std::vector<Fold> folds_;  ///< One for each position of the picture's corner within a cell.
};

/// Returns WatermarkDetector::score() of a picture that is neither scaled nor cropped. Reentrant.
[[nodiscard]] double watermark_score(std::uint64_t key, const RgbImage& picture);

}  // namespace cyclorama
