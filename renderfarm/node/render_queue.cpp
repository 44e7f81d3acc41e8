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

std::shared_ptr<const BlockOrder> RenderQueue::next(const May& may) const {
  for (const auto& [arrival, order] : cancelled_) {
    if (may(*order)) return order;
  }
  std::shared_ptr<const BlockOrder> best;
  std::optional<std::pair<std::size_t, Turn>> best_turn;
  for (const auto& [name, flow] : flows_) {
    if (best_turn && best_turn->first != name.work) break;  // Flows are sorted by class.
    const std::pair turn{name.work, flow.turn()};
    if (best_turn && *best_turn < turn) continue;
    const auto waiting = std::ranges::find_if(flow.waiting, [&](const auto& entry) { return may(*entry.second); });
    if (waiting == flow.waiting.end()) continue;
    best = waiting->second;
    best_turn = turn;
  }
  return best;
}

bool RenderQueue::has(const BlockOrder& order) const {
  const auto found = entries_.find({order.link, order.block.block()});
  return found != entries_.end() && found->second.order.get() == &order;
}

std::optional<RenderQueue::Place> RenderQueue::place_of(const BlockOrder& order) const {
  if (!has(order) || order.cancelled) return std::nullopt;
  const Entry& entry = entries_.at({order.link, order.block.block()});
  return Place{entry.flow.work, flows_.at(entry.flow).turn(), entry.turn};
}

bool RenderQueue::precedes(const BlockOrder& one, const BlockOrder& other) const {
  const auto before = place_of(other);
  if (!before) return false;
  const auto place = place_of(one);
  return !place || *place < *before;
}

double RenderQueue::seconds_ahead(const BlockOrder& of, const May& may) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto found = entries_.find({of.link, of.block.block()});
  if (found == entries_.end()) return kNever;
  const auto own = flows_.find(found->second.flow);
  if (own == flows_.end()) return kNever;
  double next = kNever;
  for (auto other = flows_.begin(); other != flows_.end(); ++other) {
    if (other->first.work != own->first.work || other == own) continue;
    const bool waits =
        std::ranges::any_of(other->second.waiting, [&](const auto& entry) { return may(*entry.second); });
    if (waits) next = std::min(next, other->second.turn().first);
  }
  return (next - own->second.turn().first) / (kPerSecond * rate_of(of.block));
}

}  // namespace cyclorama::node
