// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/block_lanes.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"

namespace cyclorama::node {
namespace {

/// Minimum duration of a piece, so that accounts that wait for each other do not alternate at every cell. A block that
/// arrives later and precedes the current one need not wait for it.
constexpr double kMinPieceSeconds = 0.005;
/// Maximum time between two reports of progress.
constexpr double kMaxPieceSeconds = 0.05;

}  // namespace

std::size_t lanes_for(int threads) {
  if (threads == 1) return 1;
  return threads < 16 ? 2 : 4;
}

bool BlockLanes::is_in_work(const BlockOrder& order) const {
  return std::ranges::any_of(lanes_, [&](const Lane& lane) { return lane.order.get() == &order; });
}

std::shared_ptr<const BlockOrder> BlockLanes::next(const RenderQueue::May& may) const {
  return queue_.next([&](const BlockOrder& order) { return !is_in_work(order) && (order.cancelled || may(order)); });
}

std::shared_ptr<const BlockOrder> BlockLanes::begin(std::size_t lane, TimePoint now, const RenderQueue::May& may) {
  CHECK(lanes_[lane].order == nullptr);
  lanes_[lane] = {.order = next(may), .began_at = now};
  update(may);
  return lanes_[lane].order;
}

void BlockLanes::end(std::size_t lane, TimePoint now, double cpu_seconds) {
  const Lane ended = std::exchange(lanes_[lane], {});
  const double wall_seconds = to_seconds(now - ended.began_at);
  if (ended.place > 0 || !(cpu_seconds > 0.0) || !(wall_seconds > 0.0)) return;
  constexpr double kNew = 0.2;
  parallelism_ = std::max(1.0, (1.0 - kNew) * parallelism_ + kNew * cpu_seconds / wall_seconds);
}

void BlockLanes::update(const RenderQueue::May& may) {
  std::vector<Lane*> used;
  for (Lane& lane : lanes_) {
    if (lane.order != nullptr) used.push_back(&lane);
  }
  std::ranges::stable_sort(used, [&](const Lane* a, const Lane* b) { return queue_.precedes(*a->order, *b->order); });
  for (std::size_t place = 0; place < used.size(); ++place) {
    Lane& lane = *used[place];
    lane.place = place;
    lane.is_preempted = false;
    const double ahead = queue_.seconds_ahead(*lane.order, may) / parallelism_;
    const double seconds = std::min(kMaxPieceSeconds, std::max(ahead, kMinPieceSeconds));
    lane.ends_at = lane.began_at + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
  }
  if (used.size() < lanes_.size()) return;
  const auto waiting = next(may);
  used.back()->is_preempted = waiting != nullptr && queue_.precedes(*waiting, *used.back()->order);
}

}  // namespace cyclorama::node
