// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/shown_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "appliance/display/yaw_shift.h"

namespace cyclorama {
namespace {

constexpr int kSlices = 256;
constexpr int kCellPx = 16;
// A pixel for each of the two filters (chroma, then light), whose chroma pixels have twice the size.
constexpr double kAround_px = 3.0;
constexpr double kWholeTurnReach_rad = 0.5;

int cells(int px) { return (px + kCellPx - 1) / kCellPx; }

/// Every cell of a picture, wanted or not.
class CellMap {
 public:
  explicit CellMap(const Panorama& picture)
      : picture_(picture), columns_(cells(picture.width_px)), wraps_(is_whole_turn(picture)) {
    wanted_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(cells(picture.height_px)), false);
  }
  /// From one place to another in pixels, either of which may lie outside.
  void want(int row, double left_px, double right_px) {
    const double width = picture_.width_px;
    if (wraps_ && right_px - left_px >= width) return mark(row, 0.0, width);
    if (!wraps_) return mark(row, left_px, right_px);
    const double turns = std::floor(left_px / width) * width;
    mark(row, left_px - turns, right_px - turns);
    if (right_px - turns > width) mark(row, 0.0, right_px - turns - width);
  }
  /// Rows that want the same columns are one part.
  [[nodiscard]] std::vector<PixelRect> parts() const {
    std::vector<PixelRect> parts;
    std::size_t above = 0;  // Where the parts that end at this row's upper edge begin.
    for (int row = 0; row < cells(picture_.height_px); ++row) {
      const std::vector<PixelRect> runs = runs_of(row);
      const bool same =
          parts.size() - above == runs.size() &&
          std::equal(runs.begin(), runs.end(), parts.begin() + static_cast<std::ptrdiff_t>(above),
                     [](const PixelRect& a, const PixelRect& b) { return a.x == b.x && a.width == b.width; });
      if (!same) {
        above = parts.size();
        parts.insert(parts.end(), runs.begin(), runs.end());
        continue;
      }
      for (std::size_t i = 0; i < runs.size(); ++i) parts[above + i].height += runs[i].height;
    }
    return parts;
  }

 private:
  void mark(int row, double left_px, double right_px) {
    const int first = static_cast<int>(std::clamp(left_px, 0.0, picture_.width_px - 1.0)) / kCellPx;
    const int last = static_cast<int>(std::clamp(right_px, 0.0, picture_.width_px - 1.0)) / kCellPx;
    for (int column = first; column <= last; ++column) wanted_[index(row, column)] = true;
  }
  [[nodiscard]] std::vector<PixelRect> runs_of(int row) const {
    const int y = row * kCellPx;
    const int height = std::min(kCellPx, picture_.height_px - y);
    std::vector<PixelRect> runs;
    for (int column = 0; column < columns_; ++column) {
      if (!wanted_[index(row, column)]) continue;
      const int x = column * kCellPx;
      const int width = std::min(kCellPx, picture_.width_px - x);
      const bool goes_on = !runs.empty() && runs.back().x + runs.back().width == x;
      if (goes_on) {
        runs.back().width += width;
      } else {
        runs.push_back({x, y, width, height});
      }
    }
    return runs;
  }
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  Panorama picture_;
  int columns_;
  bool wraps_;
  std::vector<bool> wanted_;
};

}  // namespace

HeadFootprint::HeadFootprint(const Warp& warp, const MaskImage& mask) {
  CHECK(mask.width() == width_px(warp) && mask.height() == height_px(warp));
  std::vector<PanoramaDirection> lit;
  double most_tan = -std::numeric_limits<double>::infinity();
  least_tan_ = std::numeric_limits<double>::infinity();
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!(*mask.at(x, y) > 0.0f)) continue;
      const auto direction = direction_at(warp, x, y);
      if (!direction) continue;
      lit.push_back(*direction);
      least_tan_ = std::min(least_tan_, direction->tan_elevation);
      most_tan = std::max(most_tan, direction->tan_elevation);
    }
  }
  if (lit.empty()) return;
  tan_per_slice_ = std::max((most_tan - least_tan_) / kSlices, std::numeric_limits<double>::min());
  slices_.resize(kSlices);
  for (const PanoramaDirection& direction : lit) {
    const double at = (direction.tan_elevation - least_tan_) / tan_per_slice_;
    std::optional<Span>& slice = slices_[static_cast<std::size_t>(std::clamp(at, 0.0, kSlices - 1.0))];
    if (!slice) slice = Span{direction.azimuth_rad, direction.azimuth_rad};
    slice->least_rad = std::min(slice->least_rad, direction.azimuth_rad);
    slice->most_rad = std::max(slice->most_rad, direction.azimuth_rad);
  }
}

std::optional<HeadFootprint::Span> HeadFootprint::azimuths_between(double least_tan, double most_tan) const {
  std::optional<Span> all;
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    const double lower = least_tan_ + tan_per_slice_ * static_cast<double>(i);
    if (!slices_[i] || lower > most_tan || lower + tan_per_slice_ < least_tan) continue;
    if (!all) all = slices_[i];
    all->least_rad = std::min(all->least_rad, slices_[i]->least_rad);
    all->most_rad = std::max(all->most_rad, slices_[i]->most_rad);
  }
  return all;
}

bool ShownParts::meets(const PixelRect& rect) const {
  return std::ranges::any_of(parts, [&](const PixelRect& part) {
    return rect.x < part.x + part.width && part.x < rect.x + rect.width && rect.y < part.y + part.height &&
           part.y < rect.y + rect.height;
  });
}

double turn_reach(const Panorama& picture, double shown_span_rad) {
  if (is_whole_turn(picture)) return kWholeTurnReach_rad;
  return std::max(0.0, 0.5 * (picture.azimuth_span_rad - shown_span_rad));
}

ShownParts shown_parts(const std::vector<HeadFootprint>& heads, const Panorama& picture, double shown_span_rad) {
  ShownParts shown{turn_reach(picture, shown_span_rad), {}};
  CellMap cells_of(picture);
  for (const HeadFootprint& head : heads) {
    for (int row = 0; row < cells(picture.height_px); ++row) {
      // The picture's edge stands for what lies beyond it.
      constexpr double kEndless = std::numeric_limits<double>::infinity();
      const bool is_first = row == 0;
      const bool is_last = row + 1 == cells(picture.height_px);
      const double top = is_first ? kEndless : picture.tan_elevation_at(row * kCellPx - kAround_px);
      const double bottom = is_last ? -kEndless : picture.tan_elevation_at((row + 1) * kCellPx + kAround_px);
      const auto span = head.azimuths_between(bottom, top);
      if (!span) continue;
      const auto column = [&](double azimuth) { return (azimuth / picture.azimuth_span_rad + 0.5) * picture.width_px; };
      cells_of.want(row, column(span->least_rad - shown.reach_rad) - kAround_px,
                    column(span->most_rad + shown.reach_rad) + kAround_px);
    }
  }
  shown.parts = cells_of.parts();
  std::int64_t area = 0;
  for (const PixelRect& part : shown.parts) area += part.area();
  // Where every part is seen anyway, a whole turn may be turned without end.
  if (is_whole_turn(picture) && area == std::int64_t{picture.width_px} * picture.height_px) {
    shown.reach_rad = std::numbers::pi;
  }
  return shown;
}

}  // namespace cyclorama
