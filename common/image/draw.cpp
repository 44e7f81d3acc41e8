// SPDX-License-Identifier: Apache-2.0
#include "common/image/draw.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace cyclorama {
namespace {

/// Seven rows from the top. The five low bits of a row are its columns; bit 4 is the leftmost.
struct Glyph {
  char character;
  std::array<std::uint8_t, 7> rows;
};
constexpr Glyph kFont[] = {
    {' ', {0, 0, 0, 0, 0, 0, 0}},        {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},
    {'2', {14, 17, 1, 6, 8, 16, 31}},    {'3', {30, 1, 1, 14, 1, 1, 30}},     {'4', {2, 6, 10, 18, 31, 2, 2}},
    {'5', {31, 16, 30, 1, 1, 17, 14}},   {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 4, 8, 8}},
    {'8', {14, 17, 17, 14, 17, 17, 14}}, {'9', {14, 17, 17, 15, 1, 2, 12}},   {'A', {14, 17, 17, 31, 17, 17, 17}},
    {'B', {30, 17, 17, 30, 17, 17, 30}}, {'C', {14, 17, 16, 16, 16, 17, 14}}, {'D', {30, 17, 17, 17, 17, 17, 30}},
    {'E', {31, 16, 16, 30, 16, 16, 31}}, {'F', {31, 16, 16, 30, 16, 16, 16}}, {'G', {14, 17, 16, 23, 17, 17, 14}},
    {'H', {17, 17, 17, 31, 17, 17, 17}}, {'I', {14, 4, 4, 4, 4, 4, 14}},      {'J', {7, 2, 2, 2, 2, 18, 12}},
    {'K', {17, 18, 20, 24, 20, 18, 17}}, {'L', {16, 16, 16, 16, 16, 16, 31}}, {'M', {17, 27, 21, 21, 17, 17, 17}},
    {'N', {17, 25, 21, 19, 17, 17, 17}}, {'O', {14, 17, 17, 17, 17, 17, 14}}, {'P', {30, 17, 17, 30, 16, 16, 16}},
    {'Q', {14, 17, 17, 17, 21, 18, 13}}, {'R', {30, 17, 17, 30, 20, 18, 17}}, {'S', {15, 16, 16, 14, 1, 1, 30}},
    {'T', {31, 4, 4, 4, 4, 4, 4}},       {'U', {17, 17, 17, 17, 17, 17, 14}}, {'V', {17, 17, 17, 17, 10, 10, 4}},
    {'W', {17, 17, 17, 21, 21, 27, 17}}, {'X', {17, 10, 4, 4, 4, 10, 17}},    {'Y', {17, 17, 10, 4, 4, 4, 4}},
    {'Z', {31, 1, 2, 4, 8, 16, 31}},     {'.', {0, 0, 0, 0, 0, 12, 12}},      {',', {0, 0, 0, 0, 12, 4, 8}},
    {':', {0, 12, 12, 0, 12, 12, 0}},    {'-', {0, 0, 0, 14, 0, 0, 0}},       {'+', {0, 4, 4, 31, 4, 4, 0}},
    {'/', {1, 1, 2, 4, 8, 16, 16}},      {'%', {25, 25, 2, 4, 8, 19, 19}},    {'(', {2, 4, 8, 8, 8, 4, 2}},
    {')', {8, 4, 2, 2, 2, 4, 8}},        {'=', {0, 0, 31, 0, 31, 0, 0}},      {'_', {0, 0, 0, 0, 0, 0, 31}},
    {'#', {10, 10, 31, 10, 31, 10, 10}},
};
constexpr std::array<std::uint8_t, 7> kUnknown{31, 17, 17, 17, 17, 17, 31};

const std::array<std::uint8_t, 7>& rows_of(char character) {
  const bool small = character >= 'a' && character <= 'z';
  const char wanted = small ? static_cast<char>(character - 'a' + 'A') : character;
  const auto* const found =
      std::find_if(std::begin(kFont), std::end(kFont), [&](const Glyph& glyph) { return glyph.character == wanted; });
  return found == std::end(kFont) ? kUnknown : found->rows;
}

void fill(RgbImage* picture, int left, int top, int width, int height, Colour colour) {
  const int right = std::min(left + width, picture->width());
  const int bottom = std::min(top + height, picture->height());
  for (int y = std::max(top, 0); y < bottom; ++y) {
    for (int x = std::max(left, 0); x < right; ++x) std::copy(colour.begin(), colour.end(), picture->at(x, y));
  }
}

using Segment = std::pair<std::array<double, 2>, std::array<double, 2>>;

/// Clips a line to the picture with a margin around it, however far away the line's ends are. Source: Liang and Barsky,
/// "A New Concept and Method for Line Clipping", ACM TOG 3 (1984).
std::optional<Segment> clipped(const std::array<double, 2>& from, const std::array<double, 2>& to,
                               const RgbImage& picture, double margin) {
  const std::array<double, 2> size{1.0 * picture.width(), 1.0 * picture.height()};
  double enter = 0.0;
  double leave = 1.0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double step = to[axis] - from[axis];
    const double to_low = -margin - from[axis];
    const double to_high = size[axis] + margin - from[axis];
    if (step == 0.0) {
      if (to_low > 0.0 || to_high < 0.0) return std::nullopt;
      continue;
    }
    enter = std::max(enter, std::min(to_low / step, to_high / step));
    leave = std::min(leave, std::max(to_low / step, to_high / step));
  }
  if (!(enter <= leave)) return std::nullopt;
  const auto at = [&](double t) {
    return std::array<double, 2>{from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])};
  };
  return Segment{at(enter), at(leave)};
}

}  // namespace

RgbImage to_rgb(const GreyImage& grey) {
  RgbImage rgb(grey.width(), grey.height());
  auto to = rgb.data().begin();
  for (const std::uint8_t value : grey.data()) to = std::fill_n(to, 3, value);
  return rgb;
}

void draw_line(RgbImage* picture, const std::array<double, 2>& from, const std::array<double, 2>& to, Colour colour,
               int width_px) {
  CHECK(width_px >= 1 && width_px <= 16);
  const double sum = from[0] + from[1] + to[0] + to[1];
  if (!std::isfinite(sum)) return;
  const auto line = clipped(from, to, *picture, width_px);
  if (!line) return;
  const auto& [a, b] = *line;
  const double length = std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1]));
  if (!std::isfinite(length)) return;
  const int steps = static_cast<int>(std::ceil(length)) + 1;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const double offset = 0.5 * (width_px - 1);
    fill(picture, static_cast<int>(std::floor(a[0] + t * (b[0] - a[0]) - offset)),
         static_cast<int>(std::floor(a[1] + t * (b[1] - a[1]) - offset)), width_px, width_px, colour);
  }
}

void draw_text(RgbImage* picture, int left, int top, std::string_view text, Colour colour, int scale) {
  CHECK(scale >= 1 && scale <= 16);
  for (const char character : text) {
    if (left >= picture->width()) return;
    const auto& rows = rows_of(character);
    for (int y = 0; y < 7; ++y) {
      for (int x = 0; x < 5; ++x) {
        const bool inked = ((rows[static_cast<std::size_t>(y)] >> (4 - x)) & 1) != 0;
        if (inked) fill(picture, left + x * scale, top + y * scale, scale, scale, colour);
      }
    }
    left += 6 * scale;
  }
}

}  // namespace cyclorama
