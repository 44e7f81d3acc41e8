// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/split_tree.h"

#include <algorithm>
#include <numeric>

#include "common/base/check.h"

namespace cyclorama::balance {
namespace {

/// Aspect ratio of a region beyond which its fork changes direction. A value of at most 2 keeps a block's border, and
/// thus its JPEG overhead and its share of foreign detail, close to those of a square; the margin prevents jumps.
constexpr double kTurnAtAspect = 2.0;

}  // namespace

std::vector<CellRect> SplitTree::split(const WorkSums& work, std::span<const double> speeds) {
  CHECK(2 * speeds.size() == cuts_.size());
  std::vector<CellRect> blocks(speeds.size());
  const CellRect whole = work.whole();
  if (speeds.empty() || whole.empty()) return blocks;
  const std::size_t used = std::min(speeds.size(), whole.count());
  split(whole, work, speeds.first(used), 0, std::span(blocks).first(used));
  return blocks;
}

CutDirection SplitTree::direction_for(const CellRect& region, std::size_t fork) {
  const CutDirection longer = longer_side(region);
  const CutDirection other = longer == CutDirection::kAcross ? CutDirection::kDown : CutDirection::kAcross;
  Fork& kept = cuts_[fork];
  const bool turn =
      length_of(region, longer) > kTurnAtAspect * length_of(region, other) || length_of(region, other) < 2;
  if (!kept.is_chosen || turn) kept = {longer, true};
  return kept.direction;
}

void SplitTree::split(CellRect region, const WorkSums& work, std::span<const double> speeds, std::size_t fork,
                      std::span<CellRect> ret_blocks) {
  if (speeds.size() == 1) {
    ret_blocks[0] = region;
    return;
  }
  const CutDirection d = direction_for(region, fork);
  const int length = length_of(region, d);
  const std::size_t row = region.count() / static_cast<std::size_t>(length);  // Number of cells in one step of the cut.
  std::size_t left = speeds.size() / 2;
  const double left_speed = std::accumulate(speeds.begin(), speeds.begin() + static_cast<std::ptrdiff_t>(left), 0.0);
  const double share = left_speed / std::accumulate(speeds.begin(), speeds.end(), 0.0);
  int cut = nearest_cut(work, region, d, share * work.of(region));

  // Every leaf must get a cell. In a picture with almost as many leaves as cells, leaves move to the other side if no
  // cut suffices.
  const auto steps_for = [&](std::size_t leaves) { return static_cast<int>((leaves + row - 1) / row); };
  const int min = std::min(steps_for(left), length - 1);
  const int max = std::max(length - steps_for(speeds.size() - left), 1);
  cut = min <= max ? std::clamp(cut, min, max) : min;
  const std::size_t room_left = static_cast<std::size_t>(cut) * row;
  const std::size_t room_right = region.count() - room_left;
  const std::size_t min_remaining = speeds.size() > room_right ? speeds.size() - room_right : 1;
  left = std::clamp(left, min_remaining, std::min(room_left, speeds.size() - 1));

  split(before_cut(region, d, cut), work, speeds.first(left), fork + 1, ret_blocks.first(left));
  split(after_cut(region, d, cut), work, speeds.subspan(left), fork + left, ret_blocks.subspan(left));
}

}  // namespace cyclorama::balance
