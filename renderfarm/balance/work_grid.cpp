// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/work_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "renderfarm/balance/tiles.h"

namespace cyclorama::balance {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

bool is_measurement(double value) { return std::isfinite(value) && value >= 0.0; }

bool lies_on_grid(const PixelRect& r, PictureSize size) {
  return !r.empty() && r.x >= 0 && r.y >= 0 && r.x % kCutPx == 0 && r.y % kCutPx == 0 && r.width <= size.width - r.x &&
         r.height <= size.height - r.y;
}

bool has_cell_times(const MeasuredBlock& block, const CellRect& cells) {
  return block.cell_cpu_seconds.size() == cells.count() &&
         std::ranges::all_of(block.cell_cpu_seconds, [](float s) { return is_measurement(s); });
}

/// Distributes `amount` over the cells in proportion to `weight`. Calls `take(x, y, share)` for each cell.
template <typename Weight, typename Take>
void spread(const CellRect& cells, double amount, Weight weight, Take take) {
  double sum = 0.0;
  for (int y = cells.y; y < cells.y + cells.height; ++y) {
    for (int x = cells.x; x < cells.x + cells.width; ++x) sum += weight(x, y);
  }
  if (!(sum > 0.0)) return;
  for (int y = cells.y; y < cells.y + cells.height; ++y) {
    for (int x = cells.x; x < cells.x + cells.width; ++x) take(x, y, amount * weight(x, y) / sum);
  }
}

/// Clamps a time such that a sum of many times fits into a float.
float as_work(double seconds) { return static_cast<float>(std::clamp(seconds, 0.0, 1e12)); }

void add(const MeasuredBlock& block, CellTimes times, const WorkGrid* prior, WorkGrid* ret) {
  const CellRect cells = cells_of(block.rect);
  const double speed = is_measurement(block.speed) && block.speed > 0.0 ? block.speed : 1.0;
  const auto area = [&](int x, int y) { return double(ret->width_px(x)) * ret->height_px(y); };
  for (int y = cells.y; y < cells.y + cells.height; ++y) {
    for (int x = cells.x; x < cells.x + cells.width; ++x) ret->at(x, y) = 0.0f;
  }
  double rest = block.cpu_seconds;
  if (times == CellTimes::kMeasured && has_cell_times(block, cells)) {
    auto cell_seconds = block.cell_cpu_seconds.begin();
    for (int y = cells.y; y < cells.y + cells.height; ++y) {
      for (int x = cells.x; x < cells.x + cells.width; ++x, ++cell_seconds) {
        ret->at(x, y) = as_work(*cell_seconds * speed);
        rest -= *cell_seconds;
      }
    }
  } else if (times == CellTimes::kMeasured && prior != nullptr) {
    spread(
        cells, rest, [&](int x, int y) { return double(prior->at(x, y)); },
        [&](int x, int y, double seconds) {
          ret->at(x, y) = as_work(seconds * speed);
          rest -= seconds;
        });
  }
  if (!(rest > 0.0)) return;
  spread(cells, rest, area, [&](int x, int y, double s) { ret->at(x, y) = as_work(ret->at(x, y) + s * speed); });
}

}  // namespace

int cells_in(int px) { return px <= 0 ? 0 : (px - 1) / kCutPx + 1; }

PixelRect pixels_of(const CellRect& cells, PictureSize size) {
  const int right = std::min(size.width, (cells.x + cells.width) * kCutPx);
  const int bottom = std::min(size.height, (cells.y + cells.height) * kCutPx);
  return {cells.x * kCutPx, cells.y * kCutPx, right - cells.x * kCutPx, bottom - cells.y * kCutPx};
}

CellRect cells_of(const PixelRect& rect) {
  const int x = rect.x / kCutPx;
  const int y = rect.y / kCutPx;
  return {x, y, cells_in(rect.x + rect.width) - x, cells_in(rect.y + rect.height) - y};
}

WorkGrid::WorkGrid(PictureSize size, float work)
    : size_(size),
      columns_(size.height > 0 ? cells_in(size.width) : 0),
      rows_(size.width > 0 ? cells_in(size.height) : 0),
      work_(whole().count(), work) {}

int WorkGrid::width_px(int x) const { return std::min(kCutPx, size_.width - x * kCutPx); }
int WorkGrid::height_px(int y) const { return std::min(kCutPx, size_.height - y * kCutPx); }
double WorkGrid::total() const { return std::accumulate(work_.begin(), work_.end(), 0.0); }

WorkGrid work_of(PictureSize size, std::span<const MeasuredBlock> blocks, CellTimes times, const WorkGrid* prior) {
  WorkGrid work(size, kUnknown);
  for (const MeasuredBlock& block : blocks) {
    if (lies_on_grid(block.rect, size) && is_measurement(block.cpu_seconds)) add(block, times, prior, &work);
  }
  return work;
}

}  // namespace cyclorama::balance
