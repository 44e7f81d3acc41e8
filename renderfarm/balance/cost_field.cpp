// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_field.h"

#include <algorithm>
#include <cmath>

namespace cyclorama {
namespace {

/// Cells each way: a few per block's side with 300 nodes.
constexpr int kCells = 128;
/// Of the mean density. A pixel of sky costs about this much of a pixel of rock, and a block that cost nothing must not
/// swallow the picture in the next frame.
constexpr double kLeastDensity = 0.02;
/// How much of the contrast inside a block is forgotten per frame: the visitor walks on.
constexpr double kForgotten = 0.05;

std::size_t cell_at(int x, int y) { return static_cast<std::size_t>(y * kCells + x); }
std::size_t sum_at(int x, int y) { return static_cast<std::size_t>(y * (kCells + 1) + x); }

/// How much of cell `i` lies in [from, to], both in cells.
double share_of(int i, double from, double to) {
  return std::max(0.0, std::min(i + 1.0, to) - std::max(double(i), from));
}

bool is_measurement(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

FractionRect fractions_of(const PixelRect& r, PictureSize size) {
  return {double(r.x) / size.width, double(r.y) / size.height, double(r.x + r.width) / size.width,
          double(r.y + r.height) / size.height};
}

CostField::CostField() : density_(kCells * kCells, 1.0), sums_((kCells + 1) * (kCells + 1), 0.0) { normalise(); }

void CostField::learn(PictureSize size, std::span<const MeasuredBlock> blocks) {
  if (size.width <= 0 || size.height <= 0) return;
  double measured = 0.0;
  double predicted = 0.0;
  for (const MeasuredBlock& block : blocks) {
    if (block.rect.empty() || !is_measurement(block.cpu_seconds)) continue;
    measured += block.cpu_seconds;
    predicted += cost_of(fractions_of(block.rect, size));
  }
  const double scale = predicted / measured;
  // Nothing measured, nothing but zeroes, or sums beyond double: no reason to change.
  if (!std::isfinite(scale) || scale <= 0.0) return;

  std::vector<double> learned = density_;
  for (const MeasuredBlock& block : blocks) {
    if (block.rect.empty() || !is_measurement(block.cpu_seconds)) continue;
    const FractionRect r = fractions_of(block.rect, size);
    const double cost = block.cpu_seconds * scale;
    const double mean = cost / ((r.x1 - r.x0) * (r.y1 - r.y0));
    const double factor = cost / cost_of(r);
    for (int y = int(r.y0 * kCells); y < std::min(kCells, int(std::ceil(r.y1 * kCells))); ++y) {
      for (int x = int(r.x0 * kCells); x < std::min(kCells, int(std::ceil(r.x1 * kCells))); ++x) {
        const double share = share_of(x, r.x0 * kCells, r.x1 * kCells) * share_of(y, r.y0 * kCells, r.y1 * kCells);
        const double before = density_[cell_at(x, y)];
        const double now = (1.0 - kForgotten) * before * factor + kForgotten * mean;
        learned[cell_at(x, y)] += share * (now - before);
      }
    }
  }
  density_ = std::move(learned);
  normalise();
}

void CostField::normalise() {
  double total = 0.0;
  for (const double density : density_) total += density;
  const double scale = kCells * kCells / total;
  for (double& density : density_) density = std::max(density * scale, kLeastDensity);
  constexpr double kCellArea = 1.0 / (kCells * kCells);
  for (int y = 0; y < kCells; ++y) {
    double row = 0.0;
    for (int x = 0; x < kCells; ++x) {
      row += density_[cell_at(x, y)] * kCellArea;
      sums_[sum_at(x + 1, y + 1)] = sums_[sum_at(x + 1, y)] + row;
    }
  }
}

CostField CostField::shifted_left(double fraction) const {
  if (!std::isfinite(fraction) || fraction == 0.0) return *this;
  const double by = std::clamp(fraction, -1.0, 1.0) * kCells;
  CostField shifted;
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      const double from = std::clamp(x + by, 0.0, kCells - 1.0);
      const int left = std::min(int(from), kCells - 2);
      const double t = from - left;
      shifted.density_[cell_at(x, y)] = (1.0 - t) * density_[cell_at(left, y)] + t * density_[cell_at(left + 1, y)];
    }
  }
  shifted.normalise();
  return shifted;
}

double CostField::cost_up_to(double x, double y) const {
  const double u = std::clamp(x, 0.0, 1.0) * kCells;
  const double v = std::clamp(y, 0.0, 1.0) * kCells;
  const int i = std::min(int(u), kCells - 1);
  const int j = std::min(int(v), kCells - 1);
  // Bilinear between sums is exact, as the density is constant inside a cell.
  const double s = u - i;
  const double t = v - j;
  return (1.0 - t) * ((1.0 - s) * sums_[sum_at(i, j)] + s * sums_[sum_at(i + 1, j)]) +
         t * ((1.0 - s) * sums_[sum_at(i, j + 1)] + s * sums_[sum_at(i + 1, j + 1)]);
}

double CostField::cost_of(const FractionRect& r) const {
  return cost_up_to(r.x1, r.y1) - cost_up_to(r.x0, r.y1) - cost_up_to(r.x1, r.y0) + cost_up_to(r.x0, r.y0);
}

}  // namespace cyclorama
