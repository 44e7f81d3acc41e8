// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/quality/enlarge.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/image/colour.h"

namespace cyclorama::quality {
namespace {

/// The two pixels of a row or column between which a pixel of the larger picture is, and its fractional distance from
/// the first.
struct Between {
  int first = 0;
  int second = 0;
  float part = 0.0f;
};

std::vector<Between> betweens(int from, int to) {
  std::vector<Between> result;
  for (int i = 0; i < to; ++i) {
    const double place = (i + 0.5) * from / to - 0.5;
    const int first = static_cast<int>(std::floor(place));
    result.push_back({std::clamp(first, 0, from - 1), std::clamp(first + 1, 0, from - 1),
                      static_cast<float>(place - std::floor(place))});
  }
  return result;
}

}  // namespace

RadianceImage enlarged(const RadianceImage& picture, int width, int height) {
  CHECK(!picture.empty() && width > 0 && height > 0);
  if (picture.width() == width && picture.height() == height) return picture;
  const std::vector<Between> columns = betweens(picture.width(), width);
  const std::vector<Between> rows = betweens(picture.height(), height);
  RadianceImage result(width, height);
  for (int y = 0; y < height; ++y) {
    const Between& row = rows[static_cast<std::size_t>(y)];
    for (int x = 0; x < width; ++x) {
      const Between& column = columns[static_cast<std::size_t>(x)];
      const auto between = [&](int line, int c) {
        return std::lerp(picture.at(column.first, line)[c], picture.at(column.second, line)[c], column.part);
      };
      for (int c = 0; c < 3; ++c) {
        result.at(x, y)[c] = std::lerp(between(row.first, c), between(row.second, c), row.part);
      }
    }
  }
  return result;
}

RgbImage enlarged(const RgbImage& picture, int width, int height) {
  if (picture.width() == width && picture.height() == height) return picture;
  RadianceImage light(picture.width(), picture.height());
  std::array<float, 256> linear{};
  for (std::size_t code = 0; code < 256; ++code) linear[code] = srgb_to_linear(static_cast<float>(code) / 255.0f);
  std::transform(picture.data().begin(), picture.data().end(), light.data().begin(),
                 [&](std::uint8_t code) { return linear[code]; });
  const RadianceImage large = enlarged(light, width, height);
  RgbImage result(width, height);
  std::transform(large.data().begin(), large.data().end(), result.data().begin(), linear_to_srgb8);
  return result;
}

}  // namespace cyclorama::quality
