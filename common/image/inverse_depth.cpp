// SPDX-License-Identifier: Apache-2.0
#include "common/image/inverse_depth.h"

#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace cyclorama {
namespace {

constexpr int kCompressionLevel = 3;

/// Returns the median of left, above, and (left + above - upper left).
int predicted(const InverseDepthImage& depth, int x, int y) {
  if (x == 0 && y == 0) return 0;
  if (y == 0) return *depth.at(x - 1, 0);
  if (x == 0) return *depth.at(0, y - 1);
  const int left = *depth.at(x - 1, y);
  const int above = *depth.at(x, y - 1);
  const int corner = *depth.at(x - 1, y - 1);
  const auto [lower, upper] = std::minmax(left, above);
  return std::clamp(left + above - corner, lower, upper);
}

// Maps differences of either sign near 0 to small numbers: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
unsigned folded(int difference) {
  return difference < 0 ? 2U * static_cast<unsigned>(-difference) - 1U : 2U * static_cast<unsigned>(difference);
}
int unfolded(unsigned code) {
  const int half = static_cast<int>(code / 2);
  return code % 2 == 0 ? half : -half - 1;
}

}  // namespace

std::uint16_t inverse_depth_of(float distance_m) {
  const float value = static_cast<float>(kMaxInverseDepth * kMinDepth_m) / distance_m;
  if (!(value > 0.0f)) return 0;
  return static_cast<std::uint16_t>(std::lround(std::min(value, static_cast<float>(kMaxInverseDepth))));
}

PixelRect depth_cells(const PixelRect& pixels) {
  if (pixels.empty()) return {};
  const int left = pixels.x / kDepthCellPx;
  const int top = pixels.y / kDepthCellPx;
  const int right = (pixels.x + pixels.width - 1) / kDepthCellPx + 1;
  const int bottom = (pixels.y + pixels.height - 1) / kDepthCellPx + 1;
  return {left, top, right - left, bottom - top};
}

std::string encode_inverse_depth(const InverseDepthImage& depth) {
  // First the low bytes of all codes, then the high bytes, which are nearly all zero.
  const std::size_t count = depth.data().size();
  std::vector<std::uint8_t> planes(2 * count);
  std::size_t i = 0;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x, ++i) {
      const unsigned code = folded(*depth.at(x, y) - predicted(depth, x, y));
      planes[i] = static_cast<std::uint8_t>(code & 0xff);
      planes[count + i] = static_cast<std::uint8_t>(code >> 8);
    }
  }
  std::string bytes(ZSTD_compressBound(planes.size()), '\0');
  const std::size_t size = ZSTD_compress(bytes.data(), bytes.size(), planes.data(), planes.size(), kCompressionLevel);
  CHECK(ZSTD_isError(size) == 0);
  bytes.resize(size);
  return bytes;
}

Status decode_inverse_depth(std::span<const std::byte> bytes, const PixelRect& cells, InverseDepthImage* depth) {
  CHECK(!cells.empty() && cells.x >= 0 && cells.y >= 0 && cells.x + cells.width <= depth->width() &&
        cells.y + cells.height <= depth->height());
  const auto refuse = [](const char* what) { return Error(ErrorCode::kBadData, std::string("the depth ") + what); };
  const auto count = static_cast<std::size_t>(cells.area());
  std::vector<std::uint8_t> planes(2 * count);
  const std::size_t size = ZSTD_decompress(planes.data(), planes.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) return refuse("is damaged");
  if (size != planes.size()) return refuse("is of another size than its tile");
  InverseDepthImage part(cells.width, cells.height);
  std::size_t i = 0;
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x, ++i) {
      const int value = predicted(part, x, y) + unfolded(planes[i] | static_cast<unsigned>(planes[count + i]) << 8);
      if (value < 0 || value > kMaxInverseDepth) return refuse("is out of range");
      *part.at(x, y) = static_cast<std::uint16_t>(value);
    }
  }
  for (int y = 0; y < cells.height; ++y) {
    const std::uint16_t* const row = part.at(0, y);
    std::copy(row, row + cells.width, depth->at(cells.x, cells.y + y));
  }
  return Done{};
}

}  // namespace cyclorama
