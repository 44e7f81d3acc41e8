// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_queue.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama::node {
namespace {

/// Number of tiles of the largest picture; a coordinator that lost a node may send the tiles one by one.
constexpr std::size_t kMaxBlocksPerLink = 8192;
constexpr double kPerSecond = 1e6;

/// Returns the growth of virtual time per cpu-second, which is 1 if the coordinator states none.
double rate_of(const wire::RenderBlock& block) {
  constexpr double kMaxRate = 1e9;
  const double rate = block.rank_per_cpu_second();
  return std::isfinite(rate) && rate > 0.0 ? std::min(rate, kMaxRate) : 1.0;
}

}  // namespace

RenderQueue::Turn RenderQueue::Flow::turn() const {
  const Turn& first = waiting.begin()->first;
  return {std::max(received, first.first), first.second};
}

bool RenderQueue::add(std::shared_ptr<BlockOrder> order) {
  auto& lanes = lanes_[order->link];
  std::size_t blocks = 0;
  for (const Lane& lane : lanes) blocks += lane.blocks;
  const Name name{order->link, order->block.block()};
  if (blocks >= kMaxBlocksPerLink || entries_.contains(name)) return false;
  const Rank rank = Rank::of(order->block.rank());
  const auto work = static_cast<std::size_t>(rank.work);
  const auto position = static_cast<double>(rank.position);
  Lane& lane = lanes[work];
  if (lane.blocks == 0) lane.shift = now_[work] - position;
  ++lane.blocks;
  const Entry entry{{work, order->link, order->block.account()}, {position + lane.shift, arrivals_++}, order};
  flows_[entry.flow].waiting.emplace(entry.turn, std::move(order));
  entries_.emplace(name, entry);
  take_service(entry.order->block, entry.order->link);
  return true;
}

void RenderQueue::take_service(const wire::RenderBlock& block, LinkId link) {
  for (const wire::AccountService& service : block.received()) {
    const Rank rank = Rank::of(service.rank());
    const auto work = static_cast<std::size_t>(rank.work);
    const auto flow = flows_.find({work, link, service.account()});
    if (flow == flows_.end()) continue;
    flow->second.received =
        std::max(flow->second.received, static_cast<double>(rank.position) + lanes_.at(link)[work].shift);
  }
}

void RenderQueue::leave_flow(const Entry& entry) {
  const auto flow = flows_.find(entry.flow);
  if (flow == flows_.end() || flow->second.waiting.erase(entry.turn) == 0) return;
  if (flow->second.waiting.empty()) flows_.erase(flow);
}

void RenderQueue::cancel(LinkId link, std::uint64_t block) {
  const auto found = entries_.find({link, block});
  if (found == entries_.end()) return;
  found->second.order->cancelled = true;
  leave_flow(found->second);
  cancelled_.emplace(found->second.turn.second, found->second.order);
}

void RenderQueue::serve(LinkId link, std::uint64_t block, double cpu_seconds) {
  const auto found = entries_.find({link, block});
  if (found == entries_.end() || !(cpu_seconds > 0.0)) return;
  const auto flow = flows_.find(found->second.flow);
  if (flow == flows_.end()) return;
  const double began = flow->second.turn().first;
  double& now = now_[found->second.flow.work];
  now = std::max(now, began);
  flow->second.received = began + kPerSecond * cpu_seconds * rate_of(found->second.order->block);
}

void RenderQueue::remove(LinkId link, std::uint64_t block) {
  const auto found = entries_.find({link, block});
  if (found == entries_.end()) return;
  const Entry& entry = found->second;
  if (!entry.order->cancelled) now_[entry.flow.work] = std::max(now_[entry.flow.work], entry.turn.first);
  --lanes_.at(link)[entry.flow.work].blocks;
  leave_flow(entry);
  cancelled_.erase(entry.turn.second);
  entries_.erase(found);
}

void RenderQueue::drop(LinkId link) {
  auto found = entries_.lower_bound({link, 0});
  while (found != entries_.end() && found->first.first == link) {
    found->second.order->cancelled = true;
    leave_flow(found->second);
    cancelled_.erase(found->second.turn.second);
    found = entries_.erase(found);
  }
  lanes_.erase(link);
}

RenderQueue::Flows::const_iterator RenderQueue::first(const TakesTiles& takes_tiles) const {
  auto best = flows_.end();
  for (auto flow = flows_.begin(); flow != flows_.end(); ++flow) {
    if (best != flows_.end() && flow->first.work != best->first.work) break;  // Flows are sorted by class.
    if (!takes_tiles(flow->first.link)) continue;
    if (best == flows_.end() || flow->second.turn() < best->second.turn()) best = flow;
  }
  return best;
}

std::shared_ptr<const BlockOrder> RenderQueue::next(const TakesTiles& takes_tiles) const {
  if (!cancelled_.empty()) return cancelled_.begin()->second;
  const auto flow = first(takes_tiles);
  return flow == flows_.end() ? nullptr : flow->second.waiting.begin()->second;
}

double RenderQueue::seconds_ahead(const TakesTiles& takes_tiles) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto flow = first(takes_tiles);
  if (flow == flows_.end()) return kNever;
  double next = kNever;
  for (auto other = std::next(flow); other != flows_.end(); ++other) {
    if (other->first.work != flow->first.work) break;
    if (takes_tiles(other->first.link)) next = std::min(next, other->second.turn().first);
  }
  for (auto other = flow; other != flows_.begin();) {
    --other;
    if (other->first.work != flow->first.work) break;
    if (takes_tiles(other->first.link)) next = std::min(next, other->second.turn().first);
  }
  const wire::RenderBlock& block = flow->second.waiting.begin()->second->block;
  return (next - flow->second.turn().first) / (kPerSecond * rate_of(block));
}

}  // namespace cyclorama::node
