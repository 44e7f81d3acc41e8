// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_queue.h"

namespace cyclorama {
namespace {
/// As many as the tiles of the largest picture, which a head may send one by one after it lost a node.
constexpr std::size_t kMostOfLink = 8192;
}  // namespace

bool RenderQueue::add(std::shared_ptr<BlockOrder> order) {
  const LinkId link = order->link;
  if (blocks_of_[link] >= kMostOfLink) return false;
  const Place place{true, order->block.rank(), came_++};
  if (!places_.try_emplace({link, order->block.block()}, place).second) return false;
  waiting_.emplace(place, std::move(order));
  ++blocks_of_[link];
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
  waiting_.erase(found->second);
  places_.erase(found);
  if (--blocks_of_[link] == 0) blocks_of_.erase(link);
}

void RenderQueue::drop(LinkId link) {
  auto entry = places_.lower_bound({link, 0});
  while (entry != places_.end() && entry->first.first == link) {
    const auto order = waiting_.find(entry->second);
    order->second->cancelled = true;
    waiting_.erase(order);
    entry = places_.erase(entry);
  }
  blocks_of_.erase(link);
}

std::shared_ptr<const BlockOrder> RenderQueue::next(const std::function<bool(LinkId)>& takes_tiles) const {
  for (const auto& [place, order] : waiting_) {
    if (order->cancelled || takes_tiles(order->link)) return order;
  }
  return nullptr;
}

}  // namespace cyclorama
