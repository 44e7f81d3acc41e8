// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/lit_rects.h"

#include <algorithm>

namespace cyclorama::display {
namespace {

constexpr int kBlockPx = 32;

enum class Light { kBlack, kMasked, kWhole };

Light light_of(const PixelRect& block, const warp::MaskImage& mask, const warp::BlackLiftImage* black_lift) {
  float min = 1.0f;
  float max = 0.0f;
  for (int y = block.y; y < block.y + block.height; ++y) {
    for (int x = block.x; x < block.x + block.width; ++x) {
      min = std::min(min, *mask.at(x, y));
      max = std::max({max, *mask.at(x, y), black_lift == nullptr ? 0.0f : *black_lift->at(x, y)});
    }
  }
  if (!(max > 0.0f)) return Light::kBlack;
  return min >= 1.0f ? Light::kWhole : Light::kMasked;
}

/// The blocks of one patch that are not yet in a rectangle.
class Blocks {
 public:
  Blocks(const PixelRect& patch, const warp::MaskImage& mask, const warp::BlackLiftImage* black_lift)
      : patch_(patch),
        across_((patch.width + kBlockPx - 1) / kBlockPx),
        down_((patch.height + kBlockPx - 1) / kBlockPx) {
    for (int row = 0; row < down_; ++row) {
      for (int column = 0; column < across_; ++column)
        lights_.push_back(light_of(pixels({column, row, 1, 1}), mask, black_lift));
    }
  }

  /// Cuts the patch into rectangles. Each begins at the first remaining block, and extends first to the right, then
  /// down, while the light is of the same kind.
  void cut(std::size_t patch, LitRects* ret_rects) {
    for (int row = 0; row < down_; ++row) {
      for (int column = 0; column < across_; ++column) {
        const Light light = at(column, row);
        if (light == Light::kBlack) continue;
        PixelRect blocks{column, row, 1, 1};
        while (column + blocks.width < across_ && at(column + blocks.width, row) == light) ++blocks.width;
        while (row + blocks.height < down_ && is_all({column, row + blocks.height, blocks.width, 1}, light))
          ++blocks.height;
        (light == Light::kWhole ? ret_rects->whole : ret_rects->masked).push_back({pixels(blocks), patch});
        take(blocks);
      }
    }
  }

 private:
  Light& at(int column, int row) { return lights_[static_cast<std::size_t>(row * across_ + column)]; }
  [[nodiscard]] PixelRect pixels(const PixelRect& blocks) const {
    const int x = blocks.x * kBlockPx;
    const int y = blocks.y * kBlockPx;
    return {patch_.x + x, patch_.y + y, std::min(blocks.width * kBlockPx, patch_.width - x),
            std::min(blocks.height * kBlockPx, patch_.height - y)};
  }
  bool is_all(const PixelRect& blocks, Light light) {
    for (int column = blocks.x; column < blocks.x + blocks.width; ++column) {
      if (at(column, blocks.y) != light) return false;
    }
    return true;
  }
  void take(const PixelRect& blocks) {
    for (int row = blocks.y; row < blocks.y + blocks.height; ++row) {
      for (int column = blocks.x; column < blocks.x + blocks.width; ++column) at(column, row) = Light::kBlack;
    }
  }

  PixelRect patch_;
  int across_;
  int down_;
  std::vector<Light> lights_;
};

}  // namespace

LitRects lit_rects(const warp::WarpPatches& warp, const warp::MaskImage& mask, const warp::BlackLiftImage* black_lift) {
  LitRects rects;
  for (int row = 0; row < warp.down(); ++row) {
    for (int column = 0; column < warp.across(); ++column) {
      const int x = column * warp.patch_width_px;
      const int y = row * warp.patch_height_px;
      const PixelRect patch{x, y, std::min(warp.patch_width_px, warp.width_px - x),
                            std::min(warp.patch_height_px, warp.height_px - y)};
      Blocks(patch, mask, black_lift).cut(static_cast<std::size_t>(row * warp.across() + column), &rects);
    }
  }
  return rects;
}

}  // namespace cyclorama::display
