// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "appliance/interchange/map_sampling.h"
#include "common/image/colour.h"

namespace cyclorama::interchange {
namespace {

constexpr double kLines = 10.0;
constexpr double kLineShare = 0.06;  ///< Width of a line as a share of the distance between lines.

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  [[nodiscard]] double share(float value) const {
    return high > low ? (static_cast<double>(value) - low) / (high - low) : 0.5;
  }
};

/// Returns the ranges of the mapped samples, by which maps in metres and maps of a narrow range get contrast, too.
std::array<Range, 2> ranges_of(const WarpMap& map) {
  std::array<Range, 2> ranges;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const float* const sample = map.at(x, y);
      if (!is_mapped(sample)) continue;
      for (std::size_t i = 0; i < 2; ++i) {
        ranges[i].low = std::min(ranges[i].low, static_cast<double>(sample[i]));
        ranges[i].high = std::max(ranges[i].high, static_cast<double>(sample[i]));
      }
    }
  }
  return ranges;
}

bool is_on_line(double share) {
  const double location = share * kLines;
  return std::abs(location - std::round(location)) < 0.5 * kLineShare;
}

}  // namespace

RgbImage picture_of(const WarpRegion& region) {
  CHECK(region.map.has_value());
  const WarpMap& map = *region.map;
  const std::array<Range, 2> ranges = ranges_of(map);
  RgbImage picture(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const float* const sample = map.at(x, y);
      std::uint8_t* const pixel = picture.at(x, y);
      if (!is_mapped(sample)) {
        pixel[2] = 64;
        continue;
      }
      const double u = ranges[0].share(sample[0]);
      const double v = ranges[1].share(sample[1]);
      double light = 1.0;
      if (region.alpha) light = sample_light(*region.alpha, (x + 0.5) / map.width(), (y + 0.5) / map.height());
      const bool line = is_on_line(u) || is_on_line(v);
      const std::array<double, 3> colour{line ? 1.0 : 0.1 + 0.6 * u, line ? 1.0 : 0.1 + 0.6 * v, line ? 1.0 : 0.1};
      for (std::size_t i = 0; i < 3; ++i) pixel[i] = linear_to_srgb8(static_cast<float>(light * colour[i]));
    }
  }
  return picture;
}

double mapped_fraction(const WarpRegion& region) {
  if (!region.map || region.map->empty()) return 0.0;
  double mapped = 0.0;
  for (int y = 0; y < region.map->height(); ++y) {
    for (int x = 0; x < region.map->width(); ++x) mapped += is_mapped(region.map->at(x, y)) ? 1.0 : 0.0;
  }
  return mapped / (static_cast<double>(region.map->width()) * region.map->height());
}

}  // namespace cyclorama::interchange
