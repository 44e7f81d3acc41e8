// SPDX-License-Identifier: Apache-2.0
#include "kiosk/operator/picture_check.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace cyclorama::operations {
namespace {

constexpr int kNoiseLevels = 6;  // Differences up to this level count as JPEG's noise, at quality 92.
constexpr double kBlankShare = 0.001;
constexpr int kGapPx = 4;
constexpr std::array<std::uint8_t, 3> kGround{16, 14, 12};

/// Returns the median level of each channel.
std::array<int, 3> middle_of(const RgbImage& picture) {
  std::array<std::array<std::size_t, 256>, 3> counts{};
  const auto values = picture.data();
  for (std::size_t i = 0; i < values.size(); ++i) ++counts[i % 3][values[i]];
  std::array<int, 3> middle{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::size_t below = 0;
    int level = 0;
    while (level < 255 && (below += counts[channel][static_cast<std::size_t>(level)]) * 6 < values.size()) ++level;
    middle[channel] = level;
  }
  return middle;
}

void paste(const RgbImage& picture, int x, int y, RgbImage* sheet) {
  for (int row = 0; row < picture.height(); ++row) {
    std::copy_n(picture.at(0, row), picture.row_values(), sheet->at(x, y + row));
  }
}

}  // namespace

bool is_blank(const RgbImage& picture) {
  if (picture.empty()) return true;
  const std::array<int, 3> middle = middle_of(picture);
  const auto values = picture.data();
  std::size_t different = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(int{values[i]} - middle[i % 3]) > kNoiseLevels) ++different;
  }
  return static_cast<double>(different) < kBlankShare * static_cast<double>(values.size());
}

double changed_share(const RgbImage& before, const RgbImage& after) {
  if (before.width() != after.width() || before.height() != after.height()) return 1.0;
  if (before.empty()) return 0.0;
  std::size_t changed = 0;
  const auto a = before.data();
  const auto b = after.data();
  for (std::size_t i = 0; i < a.size(); i += 3) {
    int max = 0;
    for (std::size_t c = i; c < i + 3; ++c) max = std::max(max, std::abs(int{a[c]} - int{b[c]}));
    if (max > kNoiseLevels) ++changed;
  }
  return static_cast<double>(changed) / static_cast<double>(a.size() / 3);
}

RgbImage shrunk(const RgbImage& picture, int width) {
  if (picture.width() <= width) return picture;
  const int height = std::max(1, static_cast<int>(std::int64_t{picture.height()} * width / picture.width()));
  RgbImage small(width, height);
  for (int y = 0; y < height; ++y) {
    const int top = static_cast<int>(std::int64_t{y} * picture.height() / height);
    const int bottom = std::max(top + 1, static_cast<int>(std::int64_t{y + 1} * picture.height() / height));
    for (int x = 0; x < width; ++x) {
      const int left = static_cast<int>(std::int64_t{x} * picture.width() / width);
      const int right = std::max(left + 1, static_cast<int>(std::int64_t{x + 1} * picture.width() / width));
      std::array<int, 3> sum{};
      for (int v = top; v < bottom; ++v) {
        for (int u = left; u < right; ++u) {
          for (std::size_t c = 0; c < 3; ++c) sum[c] += picture.at(u, v)[c];
        }
      }
      const int count = (bottom - top) * (right - left);
      for (std::size_t c = 0; c < 3; ++c) small.at(x, y)[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
    }
  }
  return small;
}

RgbImage contact_sheet(const std::vector<std::vector<RgbImage>>& rows, int cell_width) {
  std::vector<std::vector<RgbImage>> cells;
  std::vector<int> heights;
  std::size_t columns = 0;
  int height = kGapPx;
  for (const auto& row : rows) {
    auto& small = cells.emplace_back();
    int tallest = 0;
    for (const RgbImage& picture : row) {
      small.push_back(shrunk(picture, cell_width));
      tallest = std::max(tallest, small.back().height());
    }
    heights.push_back(tallest);
    height += tallest + kGapPx;
    columns = std::max(columns, row.size());
  }
  RgbImage sheet(static_cast<int>(columns) * (cell_width + kGapPx) + kGapPx, height);
  for (std::size_t i = 0; i < sheet.data().size(); ++i) sheet.data()[i] = kGround[i % 3];
  int y = kGapPx;
  for (std::size_t r = 0; r < cells.size(); ++r) {
    int x = kGapPx;
    for (const RgbImage& cell : cells[r]) {
      paste(cell, x, y, &sheet);
      x += cell_width + kGapPx;
    }
    y += heights[r] + kGapPx;
  }
  return sheet;
}

}  // namespace cyclorama::operations
