// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace cyclorama::node {
namespace {
/// Far more than a scene's name and a view need.
constexpr std::size_t kMaxOrderBytes = 4096;
constexpr std::size_t kMaxEndedSessions = 4096;
}  // namespace

void RenderWorker::open(std::shared_ptr<NodeLink> link) {
  const std::lock_guard lock(mutex_);
  const LinkId id = link->id();
  links_.emplace(id, std::move(link));
}

void RenderWorker::drop(LinkId link) {
  {
    const std::lock_guard lock(mutex_);
    links_.erase(link);
    queue_.drop(link);
    dropped_.push_back(link);
    look_again();
  }
  changed_.notify_all();
}

Status RenderWorker::take(LinkId link, const wire::RenderBlock& block) {
  if (block.ByteSizeLong() > kMaxOrderBytes)
    return Error(ErrorCode::kBadData, "the coordinator sent a block of many bytes");
  auto order = std::make_shared<BlockOrder>();
  order->link = link;
  order->block = block;
  order->renderer = scenes_.find(link, block.scene());
  {
    const std::lock_guard lock(mutex_);
    order->rendered_before = rendered_seconds();
    if (!queue_.add(std::move(order))) {
      return Error(ErrorCode::kBadData,
                   fmt::format("the coordinator sent block {} twice, or too many blocks", block.block()));
    }
    look_again();
  }
  changed_.notify_all();
  return Done{};
}

void RenderWorker::cancel(LinkId link, std::uint64_t block) {
  {
    const std::lock_guard lock(mutex_);
    queue_.cancel(link, block);
    look_again();
  }
  changed_.notify_all();
}

void RenderWorker::forget_session(const FilmStore::Session& session) {
  {
    const std::lock_guard lock(mutex_);
    if (ended_sessions_.size() < kMaxEndedSessions)
      ended_sessions_.push_back(session);  // Beyond the limit, films are only dropped when memory is short.
  }
  changed_.notify_all();
}

void RenderWorker::link_moved() {
  {
    const std::lock_guard lock(mutex_);
    look_again();
  }
  changed_.notify_all();
}

std::size_t RenderWorker::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool RenderWorker::wait_until_idle(TimePoint deadline, Duration quiet) {
  const auto has_work = [this] { return queue_.size() > 0; };
  std::unique_lock lock(mutex_);
  for (;;) {
    if (!changed_.wait_until(lock, deadline, [&] { return !has_work(); })) return false;
    const TimePoint until = SteadyClock().now() + quiet;
    if (!changed_.wait_until(lock, std::min(until, deadline), has_work)) return until <= deadline;
  }
}

bool RenderWorker::has_moved_since(TimePoint since) const {
  return !rendering_ || TimePoint(Duration(moved_at_.load())) >= since;
}

void RenderWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
}

std::shared_ptr<const BlockOrder> RenderWorker::next() const {
  return queue_.next([this](LinkId link) {
    const auto found = links_.find(link);
    return found == links_.end() || found->second->takes_tiles();
  });
}

void RenderWorker::look_again() { preempted_ = at_work_ != nullptr && next() != at_work_; }

double RenderWorker::rendered_seconds() const {
  return rendered_seconds_ + (at_work_ == nullptr ? 0.0 : to_seconds(SteadyClock().now() - piece_began_at_));
}

bool RenderWorker::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock,
                [this] { return stopping_ || !ended_sessions_.empty() || !dropped_.empty() || next() != nullptr; });
  return !stopping_;
}

bool RenderWorker::work() {
  const auto order = begin_piece();
  if (order == nullptr) return false;
  advance(order);
  end_piece();
  return true;
}

std::shared_ptr<const BlockOrder> RenderWorker::begin_piece() {
  const std::lock_guard lock(mutex_);
  for (const FilmStore::Session& session : std::exchange(ended_sessions_, {})) films_.forget(session);
  for (const LinkId link : std::exchange(dropped_, {})) {
    films_.forget_link(link);
    std::erase_if(begun_, [&](const auto& begun) { return begun.second.order().link == link; });
  }
  at_work_ = next();
  piece_began_at_ = SteadyClock().now();
  preempted_ = false;
  return at_work_;
}

void RenderWorker::end_piece() {
  const std::lock_guard lock(mutex_);
  rendered_seconds_ = rendered_seconds();
  at_work_ = nullptr;
}

void RenderWorker::advance(const std::shared_ptr<const BlockOrder>& order) {
  if (order->cancelled) return end_block(*order, "cancelled");
  auto found = begun_.find(order.get());
  if (found == begun_.end()) {
    auto begun = BlockWork::begin(order);
    if (!begun) return end_block(*order, begun.error().message());
    if (!order->block.keep()) films_.forget({order->link, order->block.session()});
    found = begun_.emplace(order.get(), *std::move(begun)).first;
  }
  BlockWork& work = found->second;
  const auto note = [this] { moved_at_ = SteadyClock().now().time_since_epoch().count(); };
  const BlockWork::Interrupts interrupts{[&] {
                                           note();
                                           return stopping_ || order->cancelled;
                                         },
                                         [this] { return preempted_.load(); }};
  note();
  rendering_ = true;
  auto tile = work.next_tile(films_, interrupts);
  rendering_ = false;
  if (tile) send(order->link, *std::move(tile));
  if (work.is_done()) return end_block(*order, "");
  if (order->cancelled) end_block(*order, "cancelled");
}

void RenderWorker::end_block(const BlockOrder& order, std::string error) {
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

void RenderWorker::send(LinkId link, NodeLink::Outgoing item) {
  std::shared_ptr<NodeLink> to;
  {
    const std::lock_guard lock(mutex_);
    const auto found = links_.find(link);
    if (found == links_.end()) return;
    to = found->second;
  }
  to->push(std::move(item));
}

}  // namespace cyclorama::node
