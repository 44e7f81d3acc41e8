// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace cyclorama {
namespace {
/// Far more than a scene's name and a view take.
constexpr std::size_t kMostOrderBytes = 4096;
constexpr std::size_t kMostLeft = 4096;
}  // namespace

void RenderDesk::open(std::shared_ptr<NodeLink> link) {
  const std::lock_guard lock(mutex_);
  const LinkId id = link->id();
  links_.emplace(id, std::move(link));
}

void RenderDesk::drop(LinkId link) {
  {
    const std::lock_guard lock(mutex_);
    links_.erase(link);
    queue_.drop(link);
    dropped_.push_back(link);
    look_again();
  }
  changed_.notify_all();
}

Status RenderDesk::take(LinkId link, const wire::RenderBlock& block) {
  if (block.ByteSizeLong() > kMostOrderBytes) return Error(ErrorCode::kBadData, "the head sent a block of many bytes");
  auto order = std::make_shared<BlockOrder>();
  order->link = link;
  order->block = block;
  order->renderer = scenes_.find(link, block.scene());
  {
    const std::lock_guard lock(mutex_);
    order->rendered_before = rendered_seconds();
    if (!queue_.add(std::move(order))) {
      return Error(ErrorCode::kBadData, fmt::format("the head sent block {} twice, or too many blocks", block.block()));
    }
    look_again();
  }
  changed_.notify_all();
  return Done{};
}

void RenderDesk::cancel(LinkId link, std::uint64_t block) {
  {
    const std::lock_guard lock(mutex_);
    queue_.cancel(link, block);
    look_again();
  }
  changed_.notify_all();
}

void RenderDesk::forget_visit(const FilmStore::Visit& visit) {
  {
    const std::lock_guard lock(mutex_);
    if (left_.size() < kMostLeft) left_.push_back(visit);  // Else its films leave when memory is short.
  }
  changed_.notify_all();
}

void RenderDesk::link_moved() {
  {
    const std::lock_guard lock(mutex_);
    look_again();
  }
  changed_.notify_all();
}

std::size_t RenderDesk::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool RenderDesk::wait_until_idle(TimePoint deadline, Duration quiet) {
  const auto has_work = [this] { return queue_.size() > 0; };
  std::unique_lock lock(mutex_);
  for (;;) {
    if (!changed_.wait_until(lock, deadline, [&] { return !has_work(); })) return false;
    const TimePoint until = SteadyClock().now() + quiet;
    if (!changed_.wait_until(lock, std::min(until, deadline), has_work)) return until <= deadline;
  }
}

bool RenderDesk::has_moved_since(TimePoint since) const {
  return !rendering_ || TimePoint(Duration(moved_at_.load())) >= since;
}

void RenderDesk::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
}

std::shared_ptr<const BlockOrder> RenderDesk::next() const {
  return queue_.next([this](LinkId link) {
    const auto found = links_.find(link);
    return found == links_.end() || found->second->takes_tiles();
  });
}

void RenderDesk::look_again() { gives_way_ = at_work_ != nullptr && next() != at_work_; }

double RenderDesk::rendered_seconds() const {
  return rendered_seconds_ + (at_work_ == nullptr ? 0.0 : to_seconds(SteadyClock().now() - piece_began_at_));
}

bool RenderDesk::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || !left_.empty() || !dropped_.empty() || next() != nullptr; });
  return !stopping_;
}

bool RenderDesk::work() {
  const auto order = begin_piece();
  if (order == nullptr) return false;
  advance(order);
  end_piece();
  return true;
}

std::shared_ptr<const BlockOrder> RenderDesk::begin_piece() {
  const std::lock_guard lock(mutex_);
  for (const FilmStore::Visit& visit : std::exchange(left_, {})) films_.forget(visit);
  for (const LinkId link : std::exchange(dropped_, {})) {
    films_.forget_link(link);
    std::erase_if(begun_, [&](const auto& begun) { return begun.second.order().link == link; });
  }
  at_work_ = next();
  piece_began_at_ = SteadyClock().now();
  gives_way_ = false;
  return at_work_;
}

void RenderDesk::end_piece() {
  const std::lock_guard lock(mutex_);
  rendered_seconds_ = rendered_seconds();
  at_work_ = nullptr;
}

void RenderDesk::advance(const std::shared_ptr<const BlockOrder>& order) {
  if (order->cancelled) return end_block(*order, "cancelled");
  auto found = begun_.find(order.get());
  if (found == begun_.end()) {
    auto begun = BlockWork::begin(order);
    if (!begun) return end_block(*order, begun.error().message());
    if (!order->block.keep()) films_.forget({order->link, order->block.visit()});
    found = begun_.emplace(order.get(), *std::move(begun)).first;
  }
  BlockWork& work = found->second;
  const auto note = [this] { moved_at_ = SteadyClock().now().time_since_epoch().count(); };
  const BlockWork::Interrupts interrupts{[&] {
                                           note();
                                           return stopping_ || order->cancelled;
                                         },
                                         [this] { return gives_way_.load(); }};
  note();
  rendering_ = true;
  auto tile = work.next_tile(films_, interrupts);
  rendering_ = false;
  if (tile) send(order->link, *std::move(tile));
  if (work.is_done()) return end_block(*order, "");
  if (order->cancelled) end_block(*order, "cancelled");
}

void RenderDesk::end_block(const BlockOrder& order, std::string error) {
  RenderedBlock end{order.block.block(), {}, std::move(error)};
  if (const auto begun = begun_.find(&order); begun != begun_.end()) {
    end.cost = begun->second.cost();
    begun_.erase(begun);
    const std::lock_guard lock(mutex_);
    end.waited_seconds = std::max(0.0, rendered_seconds() - order.rendered_before - end.cost.wall_seconds);
  }
  send(order.link, std::move(end));
  {
    const std::lock_guard lock(mutex_);
    queue_.remove(order.link, order.block.block());
  }
  changed_.notify_all();
}

void RenderDesk::send(LinkId link, NodeLink::Outgoing item) {
  std::shared_ptr<NodeLink> to;
  {
    const std::lock_guard lock(mutex_);
    const auto found = links_.find(link);
    if (found == links_.end()) return;
    to = found->second;
  }
  to->push(std::move(item));
}

}  // namespace cyclorama
