// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/image/image.h"
#include "common/image/watermark.h"

namespace cyclorama {

/// How likely a picture bears a key's mark: the correlation with the key's signs over its own deviation. Of a key that
/// had no part in the picture it is normally distributed with deviation 1, whatever the picture shows.
struct WatermarkFind {
  double score = 0.0;
  int x_px = 0;  ///< Where in the period the picture's upper left corner lies; 0 of a picture that was not cut.
  int y_px = 0;
};

/// Beyond what 2^16 places and some hundred keys give by chance once in a million pictures.
inline constexpr double kWatermarkCertain = 8.0;

/// Looks for many keys in one picture. Thread-bound.
class WatermarkDetector {
 public:
  /// `cell_px`: what a cell measures in this picture, kWatermarkCellPx unless it was scaled; 1 to 8.
  explicit WatermarkDetector(const RgbImage& picture, int cell_px = kWatermarkCellPx,
                             int sparseness = WatermarkStrength{}.sparseness);

  /// In its place: of a picture that was not cut.
  [[nodiscard]] double score(std::uint64_t key) const;
  /// The best of all places: 2^16 of them, so one by chance reaches about 4.5. Tenths of a second.
  [[nodiscard]] WatermarkFind search(std::uint64_t key) const;

 private:
  static constexpr int kPeriod = kWatermarkPeriodCells;
  /// What each cell of the period differs from those around it, over all periods of the picture.
  using Fold = std::array<float, static_cast<std::size_t>(kPeriod) * kPeriod>;
  [[nodiscard]] const Fold& fold_at(int x, int y) const {
    return folds_[static_cast<std::size_t>(y) * static_cast<std::size_t>(cell_px_) + static_cast<std::size_t>(x)];
  }

  int cell_px_;
  int sparseness_;
  std::vector<Fold> folds_;  ///< For each place of the corner within a cell.
};

/// WatermarkDetector::score() of a picture that is neither scaled nor cut. Reentrant.
[[nodiscard]] double watermark_score(std::uint64_t key, const RgbImage& picture);

}  // namespace cyclorama
