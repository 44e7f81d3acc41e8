// SPDX-License-Identifier: Apache-2.0
#include "drivers/camera/brightness.h"

#include <algorithm>
#include <array>

namespace cyclorama::camera {
namespace {
constexpr int kTooDark = 110;
constexpr int kTooBright = 235;
constexpr int kStridePx = 7;
}  // namespace

int bright_level(const GreyImage& picture) {
  std::array<int, 256> counts{};
  int all = 0;
  for (int y = 0; y < picture.height(); y += kStridePx) {
    for (int x = 0; x < picture.width(); x += kStridePx) {
      ++counts[*picture.at(x, y)];
      ++all;
    }
  }
  int above = 0;
  int level = 255;
  for (; level > 0; --level) {
    above += counts[static_cast<std::size_t>(level)];
    if (above * 50 > all) break;
  }
  return all == 0 ? 0 : level;
}

long next_gain(long gain, int bright_level, const GainRange& range) {
  if (range.max <= range.min) return range.min;
  const long step = std::max(range.step, 1L);
  const long stride = std::max((range.max - range.min) / 16, step);
  long wanted = std::clamp(gain, range.min, range.max);
  if (bright_level < kTooDark) wanted += std::min(stride, range.max - wanted);
  if (bright_level > kTooBright) wanted -= std::min(stride, wanted - range.min);
  return range.min + (wanted - range.min) / step * step;
}

}  // namespace cyclorama::camera
