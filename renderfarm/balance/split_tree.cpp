// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/split_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/check.h"
#include "renderfarm/balance/tiles.h"

namespace cyclorama {
namespace {

/// A fork turns its cut when its region has become this much longer the other way. At most 2 keeps a block's border,
/// and with it its JPEG overhead and its share of foreign detail, near a square's; the rest is play against jumping.
constexpr double kTurnAtAspect = 2.0;

int cells_in(int px) { return (px + kCutPx - 1) / kCutPx; }

}  // namespace

/// Part of the picture, in cells of kCutPx.
struct SplitTree::Region {
  PictureSize size;
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] int length(Direction d) const { return d == Direction::kAcross ? width : height; }
  [[nodiscard]] std::size_t cells() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  [[nodiscard]] PixelRect pixels() const {
    const int right = std::min(size.width, (x + width) * kCutPx);
    const int bottom = std::min(size.height, (y + height) * kCutPx);
    return {x * kCutPx, y * kCutPx, right - x * kCutPx, bottom - y * kCutPx};
  }
  [[nodiscard]] FractionRect fractions() const { return fractions_of(pixels(), size); }
  [[nodiscard]] Region first(Direction d, int cut) const {
    Region part = *this;
    (d == Direction::kAcross ? part.width : part.height) = cut;
    return part;
  }
  [[nodiscard]] Region second(Direction d, int cut) const {
    Region part = *this;
    (d == Direction::kAcross ? part.x : part.y) += cut;
    (d == Direction::kAcross ? part.width : part.height) -= cut;
    return part;
  }
};

std::vector<PixelRect> SplitTree::split(PictureSize size, const CostField& cost, std::span<const double> speeds) {
  CHECK(2 * speeds.size() == cut_across_.size());
  std::vector<PixelRect> blocks(speeds.size());
  if (speeds.empty() || size.width <= 0 || size.height <= 0) return blocks;
  const Region whole{size, 0, 0, cells_in(size.width), cells_in(size.height)};
  const std::size_t used = std::min(speeds.size(), whole.cells());
  split(whole, cost, speeds.first(used), 0, std::span(blocks).first(used));
  return blocks;
}

SplitTree::Direction SplitTree::direction_for(const Region& region, std::size_t fork) {
  const Direction longer = region.width >= region.height ? Direction::kAcross : Direction::kDown;
  const Direction other = longer == Direction::kAcross ? Direction::kDown : Direction::kAcross;
  Direction& kept = cut_across_[fork];
  const bool turn = region.length(longer) > kTurnAtAspect * region.length(other) || region.length(other) < 2;
  if (kept == Direction::kUnset || turn) kept = longer;
  return kept;
}

void SplitTree::split(Region region, const CostField& cost, std::span<const double> speeds, std::size_t fork,
                      std::span<PixelRect> ret_blocks) {
  if (speeds.size() == 1) {
    ret_blocks[0] = region.pixels();
    return;
  }
  const Direction d = direction_for(region, fork);
  const int length = region.length(d);
  const std::size_t row = region.cells() / static_cast<std::size_t>(length);  // Cells that one step of the cut frees.
  std::size_t left = speeds.size() / 2;
  const double left_speed = std::accumulate(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(left), 0.0);
  const double share = left_speed / std::accumulate(speeds.begin(), speeds.end(), 0.0);
  const double wanted = share * cost.cost_of(region.fractions());

  // The cost left of a cut grows with the cut: the first cut that reaches what is wanted, or the one before.
  int low = 1;
  int high = length - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (cost.cost_of(region.first(d, middle).fractions()) < wanted) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const auto miss = [&](int at) { return std::abs(cost.cost_of(region.first(d, at).fractions()) - wanted); };
  int cut = low > 1 && miss(low - 1) < miss(low) ? low - 1 : low;

  // Every node must get a cell. In a picture of almost as many nodes as cells, nodes change sides where no cut can do
  // it.
  const auto steps_for = [&](std::size_t nodes) { return static_cast<int>((nodes + row - 1) / row); };
  const int least = std::min(steps_for(left), length - 1);
  const int most = std::max(length - steps_for(speeds.size() - left), 1);
  cut = least <= most ? std::clamp(cut, least, most) : least;
  const std::size_t room_left = static_cast<std::size_t>(cut) * row;
  const std::size_t room_right = region.cells() - room_left;
  const std::size_t fewest_left = speeds.size() > room_right ? speeds.size() - room_right : 1;
  left = std::clamp(left, fewest_left, std::min(room_left, speeds.size() - 1));

  const Region a = region.first(d, cut);
  const Region b = region.second(d, cut);
  split(a, cost, speeds.first(left), fork + 1, ret_blocks.first(left));
  split(b, cost, speeds.subspan(left), fork + left, ret_blocks.subspan(left));
}

}  // namespace cyclorama
