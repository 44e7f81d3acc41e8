// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/frame_assembly.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "renderfarm/balance/tiles.h"

namespace cyclorama::coordinator {
namespace {

/// Minimum length of a part in pixels; shorter parts cost more in margins and JPEG overhead.
constexpr int kMinPartPx = 64;

/// Returns the measured costs of a block's cells; empty unless there is one for each cell that the block touches.
std::vector<float> measured_cells(const wire::BlockEnd& end, const PixelRect& rect) {
  const auto touched = [](int from, int length) { return (from + length + kCutPx - 1) / kCutPx - from / kCutPx; };
  const int cells = touched(rect.x, rect.width) * touched(rect.y, rect.height);
  if (end.cell_cpu_seconds_size() != cells) return {};
  std::vector<float> out;
  for (const float seconds : end.cell_cpu_seconds()) out.push_back(static_cast<float>(measured_seconds(seconds)));
  return out;
}

}  // namespace

double measured_seconds(double seconds) { return std::isfinite(seconds) ? std::clamp(seconds, 0.0, 1e6) : 0.0; }

void FrameAssembly::plan(std::uint64_t block, NodeId node, const PixelRect& rect, const BlockForecast& forecast) {
  const std::vector<PixelRect> tiles = balance::tiles_of(rect);
  for (const PixelRect& tile : tiles) {
    ++attempts_[tile];
    ++missing_[tile];
  }
  CHECK(blocks_.emplace(block, Block{node, rect, forecast, tiles}).second);
  outstanding_[node].push_back(block);
}

void FrameAssembly::replan(std::uint64_t block, NodeId node, const PixelRect& tile) {
  CHECK(missing_.contains(tile));
  reassigned_ = true;
  plan(block, node, tile);
}

std::vector<PixelRect> FrameAssembly::cut(const PixelRect& tile, std::size_t parts) {
  const auto missing = missing_.find(tile);
  CHECK(missing != missing_.end() && missing->second == 0);
  const bool across = tile.width >= tile.height;
  const int length = across ? tile.width : tile.height;
  const int max = std::max(1, length / kMinPartPx);
  const int count = static_cast<int>(std::min<std::size_t>(parts, static_cast<std::size_t>(max)));
  if (count < 2) return {tile};
  std::vector<PixelRect> out;
  const int cells = (length + kCutPx - 1) / kCutPx;
  for (int i = 0; i < count; ++i) {
    const int from = cells * i / count * kCutPx;
    const int to = std::min(length, cells * (i + 1) / count * kCutPx);
    PixelRect part = tile;
    (across ? part.x : part.y) += from;
    (across ? part.width : part.height) = to - from;
    out.push_back(part);
    attempts_[part] = attempts_[tile];
    missing_[part] = 0;
  }
  missing_.erase(missing);
  parts_[tile] = out;
  return out;
}

void FrameAssembly::move(std::uint64_t from, std::uint64_t block, NodeId node, double speed) {
  Block& left = blocks_.at(from);
  CHECK(left.wanted && !left.ended && left.delivered == 0);
  settle(from, left);
  left.wanted = false;
  left.moved = true;
  Block taken{node, left.rect, left.forecast, left.tiles};
  taken.forecast.speed = speed;
  CHECK(blocks_.emplace(block, std::move(taken)).second);
  outstanding_[node].push_back(block);
}

void FrameAssembly::settle(std::uint64_t number, const Block& block) {
  if (!block.is_outstanding()) return;
  const auto owing = outstanding_.find(block.node);
  std::erase(owing->second, number);
  if (owing->second.empty()) outstanding_.erase(owing);
}

bool FrameAssembly::take(const PixelRect& tile) {
  if (missing_.erase(tile) > 0) return true;
  const auto cut = parts_.find(tile);
  if (cut == parts_.end()) return false;
  // Some part may have been delivered; the whole tile is then unwanted.
  if (!is_untouched(tile)) return false;
  for (const PixelRect& part : cut->second) take(part);
  return true;
}

bool FrameAssembly::is_untouched(const PixelRect& tile) const {
  if (missing_.contains(tile)) return true;
  const auto cut = parts_.find(tile);
  return cut != parts_.end() &&
         std::ranges::all_of(cut->second, [this](const PixelRect& part) { return is_untouched(part); });
}

FrameAssembly::Verdict FrameAssembly::accept(std::uint64_t block, const PixelRect& tile) {
  const auto found = blocks_.find(block);
  if (found == blocks_.end() || std::ranges::find(found->second.tiles, tile) == found->second.tiles.end()) {
    return Verdict::kForeign;
  }
  if (!take(tile)) return Verdict::kDuplicate;
  ++delivered_;
  ++found->second.delivered;
  return Verdict::kNew;
}

void FrameAssembly::end(std::uint64_t block, const wire::BlockEnd& end) {
  Block& ended = blocks_.at(block);
  settle(block, ended);
  ended.ended = true;
  ended.end = end;
}

std::vector<PixelRect> FrameAssembly::give_up(std::uint64_t block) {
  Block& lost = blocks_.at(block);
  std::vector<PixelRect> orphans;
  settle(block, lost);
  if (!std::exchange(lost.wanted, false)) return orphans;
  for (const PixelRect& tile : lost.tiles) {
    const auto missing = missing_.find(tile);
    if (missing != missing_.end() && --missing->second == 0) orphans.push_back(tile);
  }
  return orphans;
}

void FrameAssembly::forgive_attempt(std::uint64_t block) {
  for (const PixelRect& tile : blocks_.at(block).tiles) {
    if (missing_.contains(tile)) --attempts_[tile];
  }
}

int FrameAssembly::attempts(const PixelRect& tile) const {
  const auto found = attempts_.find(tile);
  return found == attempts_.end() ? 0 : found->second;
}

bool FrameAssembly::is_complete() const {
  if (!missing_.empty()) return false;
  // The times of wanted blocks are needed, too, but not after a reassignment, when other nodes may have been faster.
  return reassigned_ || outstanding_.empty();
}

FrameAssembly::Summary FrameAssembly::summary() const {
  Summary sum;
  std::map<NodeId, double> walls;
  for (const auto& [number, block] : blocks_) {
    if (!block.ended) continue;
    const double cpu_seconds = measured_seconds(block.end.render_cpu_seconds());
    const double wall_seconds = measured_seconds(block.end.wall_seconds());
    sum.render_seconds = std::max(sum.render_seconds, walls[block.node] += wall_seconds);
    sum.away_seconds = std::max(sum.away_seconds, measured_seconds(block.end.waited_seconds()) + wall_seconds);
    sum.encode_seconds = std::max(sum.encode_seconds, measured_seconds(block.end.encode_cpu_seconds()));
    sum.cpu_seconds += cpu_seconds;
    sum.rays += block.end.rays();
    if (!block.moved && block.end.error().empty()) {
      sum.costs.push_back({block.rect, cpu_seconds, measured_cells(block.end, block.rect), block.forecast.speed});
    }
    sum.loads[block.node] += cpu_seconds;
  }
  return sum;
}

}  // namespace cyclorama::coordinator
