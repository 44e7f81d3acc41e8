// SPDX-License-Identifier: Apache-2.0
#include "common/image/watermark_detector.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama {
namespace {

constexpr int kPeriod = kWatermarkPeriodCells;
/// Limit of a cell's difference, so that an edge in the picture does not outweigh the many cells that show the mark.
/// `cyclorama-bench-render watermark --curve` finds less evidence with 2 and with 4.
constexpr float kClipCodes = 3.0f;
using Pattern = std::array<std::int8_t, static_cast<std::size_t>(kPeriod) * kPeriod>;

Pattern pattern_of(std::uint64_t key, int sparseness) {
  Pattern pattern{};
  for (int y = 0; y < kPeriod; ++y) {
    const WatermarkRow row = watermark_row(key, y, sparseness);
    for (int x = 0; x < kPeriod; ++x) {
      const int sign = (row.lighter >> x & 1) != 0 ? 1 : -1;
      pattern[static_cast<std::size_t>(y * kPeriod + x)] =
          static_cast<std::int8_t>((row.marked >> x & 1) != 0 ? sign : 0);
    }
  }
  return pattern;
}

/// Returns the mean luma of whole cells from (x0, y0) on, in code values.
Image<float, 1> cell_means(const RgbImage& picture, int x0, int y0, int cell_px) {
  Image<float, 1> means(std::max(0, (picture.width() - x0) / cell_px), std::max(0, (picture.height() - y0) / cell_px));
  const float scale = 1.0f / static_cast<float>(256 * cell_px * cell_px);
  for (int y = 0; y < means.height(); ++y) {
    for (int x = 0; x < means.width(); ++x) {
      int sum = 0;
      for (int j = 0; j < cell_px; ++j) {
        const std::uint8_t* p = picture.at(x0 + x * cell_px, y0 + y * cell_px + j);
        for (int i = 0; i < cell_px; ++i, p += 3) sum += 77 * p[0] + 150 * p[1] + 29 * p[2];
      }
      *means.at(x, y) = scale * static_cast<float>(sum);
    }
  }
  return means;
}

/// Returns a cell's difference from the mean of the eight cells around it, clipped.
float residual(const Image<float, 1>& means, int x, int y) {
  float around = -*means.at(x, y);
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) around += *means.at(x + i, y + j);
  }
  return std::clamp(*means.at(x, y) - 0.125f * around, -kClipCodes, kClipCodes);
}

float energy(float value) { return value * value; }

}  // namespace

WatermarkDetector::WatermarkDetector(const RgbImage& picture, int cell_px, int sparseness)
    : cell_px_(cell_px), sparseness_(sparseness) {
  CHECK(cell_px >= 1 && cell_px <= 8);
  for (int y0 = 0; y0 < cell_px; ++y0) {
    for (int x0 = 0; x0 < cell_px; ++x0) {
      Fold& fold = folds_.emplace_back();
      fold.fill(0.0f);
      const Image<float, 1> means = cell_means(picture, x0, y0, cell_px);
      for (int y = 1; y + 1 < means.height(); ++y) {
        for (int x = 1; x + 1 < means.width(); ++x) {
          fold[static_cast<std::size_t>(y % kPeriod * kPeriod + x % kPeriod)] += residual(means, x, y);
        }
      }
    }
  }
}

double WatermarkDetector::score(std::uint64_t key) const {
  const Pattern pattern = pattern_of(key, sparseness_);
  const Fold& fold = fold_at(0, 0);
  double sum = 0.0;
  double variance = 0.0;
  for (std::size_t i = 0; i < fold.size(); ++i) {
    sum += static_cast<double>(fold[i]) * pattern[i];
    if (pattern[i] != 0) variance += energy(fold[i]);
  }
  return variance > 0.0 ? sum / std::sqrt(variance) : 0.0;
}

WatermarkFind WatermarkDetector::search(std::uint64_t key) const {
  const Pattern pattern = pattern_of(key, sparseness_);
  // The pattern, stored twice side by side, so that a shifted row is contiguous in memory.
  std::array<float, static_cast<std::size_t>(2) * kPeriod * kPeriod> wide{};
  for (int y = 0; y < kPeriod; ++y) {
    for (int x = 0; x < 2 * kPeriod; ++x) {
      wide[static_cast<std::size_t>(y * 2 * kPeriod + x)] =
          static_cast<float>(pattern[static_cast<std::size_t>(y * kPeriod + x % kPeriod)]);
    }
  }
  const double share = std::ldexp(1.0, -sparseness_);
  WatermarkFind best{score(key), 0, 0};
  for (int y0 = 0; y0 < cell_px_; ++y0) {
    for (int x0 = 0; x0 < cell_px_; ++x0) {
      const Fold& fold = fold_at(x0, y0);
      double variance = 0.0;
      for (const float value : fold) variance += energy(value);
      if (!(variance > 0.0)) continue;
      const double scale = 1.0 / std::sqrt(share * variance);
      for (int dy = 0; dy < kPeriod; ++dy) {
        for (int dx = 0; dx < kPeriod; ++dx) {
          std::array<float, 16> sums{};  // Independent sums, so that the compiler adds them as vectors.
          for (int y = 0; y < kPeriod; ++y) {
            const float* const signs = wide.data() + (y + dy) % kPeriod * 2 * kPeriod + dx;
            const float* const values = fold.data() + y * kPeriod;
            for (std::size_t x = 0; x < kPeriod; x += sums.size()) {
              for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += signs[x + i] * values[x + i];
            }
          }
          double sum = 0.0;
          for (const float part : sums) sum += part;
          if (sum * scale <= best.score) continue;
          // The first whole cell begins x0 after the corner and is column dx of the period.
          const int period_px = kPeriod * cell_px_;
          best = {sum * scale, (dx * cell_px_ - x0 + period_px) % period_px,
                  (dy * cell_px_ - y0 + period_px) % period_px};
        }
      }
    }
  }
  return best;
}

double watermark_score(std::uint64_t key, const RgbImage& picture) { return WatermarkDetector(picture).score(key); }

}  // namespace cyclorama
