// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_queue.h"

#include <algorithm>

#include "common/wire/rank.h"

namespace cyclorama::node {
namespace {
/// The number of tiles of the largest picture, which a coordinator may send one by one after it lost a node.
constexpr std::size_t kMaxBlocksPerLink = 8192;
}  // namespace

bool RenderQueue::add(std::shared_ptr<BlockOrder> order) {
  Lanes& lanes = lanes_[order->link];
  const Name name{order->link, order->block.block()};
  if (lanes[0].blocks + lanes[1].blocks >= kMaxBlocksPerLink || places_.contains(name)) return false;
  const bool at_rest = order->block.rank() >= kRankAtRest;
  const auto rank = static_cast<double>(at_rest ? order->block.rank() - kRankAtRest : order->block.rank());
  Lane& lane = lanes[at_rest];
  if (lane.blocks == 0) lane.shift = now_[at_rest] - rank;
  ++lane.blocks;
  const Place place{true, at_rest, rank + lane.shift, arrivals_++};
  places_.emplace(name, place);
  waiting_.emplace(place, std::move(order));
  return true;
}

void RenderQueue::cancel(LinkId link, std::uint64_t block) {
  const auto found = places_.find({link, block});
  if (found == places_.end()) return;
  auto entry = waiting_.extract(found->second);
  entry.mapped()->cancelled = true;
  std::get<0>(entry.key()) = false;
  found->second = entry.key();
  waiting_.insert(std::move(entry));
}

void RenderQueue::remove(LinkId link, std::uint64_t block) {
  const auto found = places_.find({link, block});
  if (found == places_.end()) return;
  const auto& [is_wanted, at_rest, rank, arrival] = found->second;
  if (is_wanted) now_[at_rest] = std::max(now_[at_rest], rank);
  --lanes_.at(link)[at_rest].blocks;
  waiting_.erase(found->second);
  places_.erase(found);
}

void RenderQueue::drop(LinkId link) {
  auto entry = places_.lower_bound({link, 0});
  while (entry != places_.end() && entry->first.first == link) {
    const auto order = waiting_.find(entry->second);
    order->second->cancelled = true;
    waiting_.erase(order);
    entry = places_.erase(entry);
  }
  lanes_.erase(link);
}

std::shared_ptr<const BlockOrder> RenderQueue::next(const std::function<bool(LinkId)>& takes_tiles) const {
  for (const auto& [place, order] : waiting_) {
    if (order->cancelled || takes_tiles(order->link)) return order;
  }
  return nullptr;
}

}  // namespace cyclorama::node
