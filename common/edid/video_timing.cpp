// SPDX-License-Identifier: Apache-2.0
#include "common/edid/video_timing.h"

#include <cmath>

#include "common/base/check.h"

namespace cyclorama {
namespace {

constexpr int kCellPx = 8;  // Widths are counted in character cells.
constexpr double kClockStep_khz = 250.0;

/// Lines of the vertical sync pulse, by which a display recognises the aspect ratio.
int sync_lines(int width_px, int height_px) {
  struct Aspect {
    int width;
    int height;
    int lines;
  };
  for (const auto& [width, height, lines] :
       {Aspect{4, 3, 4}, Aspect{16, 9, 5}, Aspect{16, 10, 6}, Aspect{5, 4, 7}, Aspect{15, 9, 7}}) {
    if (width_px * height == height_px * width) return lines;
  }
  return 10;
}

VideoTiming reduced(int width_px, int height_px, double refresh_hz) {
  constexpr double kMinBlank_us = 460.0;
  constexpr int kFrontLines = 3;
  constexpr int kMinBackLines = 6;
  const int sync = sync_lines(width_px, height_px);
  const double line_us = (1e6 / refresh_hz - kMinBlank_us) / height_px;
  const int min_blank = kFrontLines + sync + kMinBackLines;
  const int blank = line_us > 0.0 ? std::max(static_cast<int>(kMinBlank_us / line_us) + 1, min_blank) : min_blank;
  VideoTiming timing;
  timing.horizontal = {width_px, 48, 32, 80, true};
  timing.vertical = {height_px, kFrontLines, sync, blank - kFrontLines - sync, false};
  const double exact_khz = refresh_hz * timing.vertical.total() * timing.horizontal.total() / 1000.0;
  timing.clock_khz = static_cast<int>(std::floor(exact_khz / kClockStep_khz) * kClockStep_khz);
  return timing;
}

VideoTiming full(int width_px, int height_px, double refresh_hz) {
  constexpr double kMinSyncAndBack_us = 550.0;
  constexpr int kFrontLines = 3;
  constexpr int kMinBackLines = 6;
  constexpr double kBlankOffset_percent = 30.0;      // C' of the formula.
  constexpr double kBlankGradient_percent_us = 0.3;  // M' / 1000.
  const int sync = sync_lines(width_px, height_px);
  const double line_us = (1e6 / refresh_hz - kMinSyncAndBack_us) / (height_px + kFrontLines);
  if (line_us <= 0.0) return {};
  const int sync_and_back = std::max(static_cast<int>(kMinSyncAndBack_us / line_us) + 1, sync + kMinBackLines);
  const double duty = std::max(20.0, kBlankOffset_percent - kBlankGradient_percent_us * line_us);
  const int blank = static_cast<int>(width_px * duty / (100.0 - duty) / (2 * kCellPx)) * 2 * kCellPx;
  const int total = width_px + blank;
  const int h_sync = static_cast<int>(std::floor(0.08 * total / kCellPx)) * kCellPx;
  VideoTiming timing;
  timing.horizontal = {width_px, blank / 2 - h_sync, h_sync, blank / 2, false};
  timing.vertical = {height_px, kFrontLines, sync, sync_and_back - sync, true};
  timing.clock_khz = static_cast<int>(std::floor(total * 1000.0 / line_us / kClockStep_khz) * kClockStep_khz);
  return timing;
}

}  // namespace

double VideoTiming::refresh_hz() const {
  const int hidden = vertical.total() - vertical.visible;
  const int of_field = vertical.visible / 2 + hidden;
  const double lines = is_interlaced ? of_field + 0.5 : vertical.total();
  const double pixels = horizontal.total() * lines;
  return pixels > 0.0 ? 1000.0 * clock_khz / pixels : 0.0;
}

bool VideoTiming::is_possible() const {
  constexpr int kMaxTotal = 65535;
  const auto is_axis = [](const TimingAxis& axis) {
    return axis.visible > 0 && axis.front_porch >= 0 && axis.sync > 0 && axis.back_porch >= 0 &&
           axis.total() <= kMaxTotal;
  };
  return is_axis(horizontal) && is_axis(vertical) && refresh_hz() >= 5.0 && refresh_hz() <= 1000.0;
}

VideoTiming coordinated_timing(int width_px, int height_px, double refresh_hz, bool is_reduced) {
  CHECK(width_px > 0 && height_px > 0 && refresh_hz > 0.0);
  const int cells_px = width_px / kCellPx * kCellPx;
  return is_reduced ? reduced(cells_px, height_px, refresh_hz) : full(cells_px, height_px, refresh_hz);
}

}  // namespace cyclorama
