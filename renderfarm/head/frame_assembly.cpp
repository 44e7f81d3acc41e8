// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/head/frame_assembly.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "renderfarm/balance/tiles.h"

namespace cyclorama {
namespace {

/// What a node says about itself is not believed beyond reason: it goes into the next frame's plan.
double measured(double seconds) { return std::isfinite(seconds) ? std::clamp(seconds, 0.0, 1e6) : 0.0; }

}  // namespace

void FrameAssembly::plan(std::uint64_t block, NodeId node, const PixelRect& rect) {
  const std::vector<PixelRect> tiles = tiles_of(rect);
  for (const PixelRect& tile : tiles) {
    ++attempts_[tile];
    ++missing_[tile];
  }
  CHECK(blocks_.emplace(block, Block{node, rect, tiles}).second);
}

void FrameAssembly::plan_again(std::uint64_t block, NodeId node, const PixelRect& tile) {
  CHECK(missing_.contains(tile));
  given_again_ = true;
  plan(block, node, tile);
}

FrameAssembly::Verdict FrameAssembly::accept(std::uint64_t block, const PixelRect& tile) {
  const auto found = blocks_.find(block);
  if (found == blocks_.end() || std::ranges::find(found->second.tiles, tile) == found->second.tiles.end()) {
    return Verdict::kForeign;
  }
  if (missing_.erase(tile) == 0) return Verdict::kDuplicate;
  ++delivered_;
  return Verdict::kNew;
}

void FrameAssembly::end(std::uint64_t block, const wire::BlockEnd& end) {
  Block& ended = blocks_.at(block);
  ended.ended = true;
  ended.end = end;
}

std::vector<PixelRect> FrameAssembly::give_up(std::uint64_t block) {
  Block& lost = blocks_.at(block);
  std::vector<PixelRect> orphans;
  if (!std::exchange(lost.wanted, false)) return orphans;
  for (const PixelRect& tile : lost.tiles) {
    const auto missing = missing_.find(tile);
    if (missing != missing_.end() && --missing->second == 0) orphans.push_back(tile);
  }
  return orphans;
}

int FrameAssembly::attempts(const PixelRect& tile) const {
  const auto found = attempts_.find(tile);
  return found == attempts_.end() ? 0 : found->second;
}

bool FrameAssembly::is_complete() const {
  if (!missing_.empty()) return false;
  // The times are wanted too, but not from a race that somebody else has won.
  return given_again_ ||
         std::ranges::all_of(blocks_, [](const auto& entry) { return entry.second.ended || !entry.second.wanted; });
}

FrameAssembly::Summary FrameAssembly::summary() const {
  Summary sum;
  for (const auto& [number, block] : blocks_) {
    if (!block.ended) continue;
    const double cpu_seconds = measured(block.end.render_cpu_seconds());
    sum.render_seconds = std::max(sum.render_seconds, measured(block.end.wall_seconds()));
    sum.encode_seconds = std::max(sum.encode_seconds, measured(block.end.encode_cpu_seconds()));
    sum.cpu_seconds += cpu_seconds;
    sum.rays += block.end.rays();
    sum.costs.push_back({block.rect, cpu_seconds});
    sum.loads[block.node] += cpu_seconds;
  }
  return sum;
}

}  // namespace cyclorama
