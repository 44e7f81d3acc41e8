// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <utility>

namespace cyclorama::node {
namespace {
/// Maximum size of an order, far more than the name of a scene and a view need.
constexpr std::size_t kMaxOrderBytes = 4096;
constexpr std::size_t kMaxEndedSessions = 4096;
/// Minimum duration of a piece, so that accounts that wait for each other do not alternate at every cell. A block that
/// arrives later and precedes the current one need not wait for it.
constexpr double kMinPieceSeconds = 0.005;
/// Maximum time between two reports of progress.
constexpr double kMaxPieceSeconds = 0.05;
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
      ended_sessions_.push_back(session);  // Films of sessions beyond the limit are dropped when memory is short.
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

RenderQueue::TakesTiles RenderWorker::takes_tiles() const {
  return [this](LinkId link) {
    const auto found = links_.find(link);
    return found == links_.end() || found->second->takes_tiles();
  };
}

std::shared_ptr<const BlockOrder> RenderWorker::next() const { return queue_.next(takes_tiles()); }

void RenderWorker::look_again() {
  preempted_ = at_work_ != nullptr && next() != at_work_;
  if (at_work_ != nullptr && !preempted_) limit_piece();
}

void RenderWorker::limit_piece() {
  const double ahead = queue_.seconds_ahead(takes_tiles()) / parallelism_;
  const double seconds = std::min(kMaxPieceSeconds, std::max(ahead, kMinPieceSeconds));
  ends_at_ = (piece_began_at_ + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds)))
                 .time_since_epoch()
                 .count();
}

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
  end_piece(advance(order));
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
  limit_piece();
  return at_work_;
}

void RenderWorker::end_piece(double cpu_seconds) {
  const std::lock_guard lock(mutex_);
  const double wall_seconds = to_seconds(SteadyClock().now() - piece_began_at_);
  if (cpu_seconds > 0.0 && wall_seconds > 0.0) {
    constexpr double kNew = 0.2;
    parallelism_ = std::max(1.0, (1.0 - kNew) * parallelism_ + kNew * cpu_seconds / wall_seconds);
  }
  rendered_seconds_ = rendered_seconds();
  at_work_ = nullptr;
}

double RenderWorker::advance(const std::shared_ptr<const BlockOrder>& order) {
  if (order->cancelled) {
    end_block(*order, "cancelled");
    return 0.0;
  }
  try {
    return render_piece(order);
  } catch (const std::bad_alloc&) {
    rendering_ = false;
    end_block(*order, "this node has not enough memory for the block");
    return 0.0;
  }
}

double RenderWorker::render_piece(const std::shared_ptr<const BlockOrder>& order) {
  auto found = begun_.find(order.get());
  if (found == begun_.end()) {
    auto begun = BlockWork::begin(order);
    if (!begun) {
      end_block(*order, begun.error().message());
      return 0.0;
    }
    if (!order->block.keep()) films_.forget({order->link, order->block.session()});
    found = begun_.emplace(order.get(), *std::move(begun)).first;
  }
  BlockWork& work = found->second;
  const double before = work.cost().cpu_seconds;
  const BlockWork::Interrupts interrupts{[&] { return stopping_ || order->cancelled; },
                                         [&] {
                                           const Duration::rep now = SteadyClock().now().time_since_epoch().count();
                                           moved_at_ = now;
                                           return preempted_ || now >= ends_at_;
                                         }};
  moved_at_ = SteadyClock().now().time_since_epoch().count();
  rendering_ = true;
  auto tile = work.next_tile(films_, interrupts);
  rendering_ = false;
  const double cpu_seconds = work.cost().cpu_seconds - before;
  {
    const std::lock_guard lock(mutex_);
    queue_.serve(order->link, order->block.block(), cpu_seconds);
  }
  if (tile) {
    send(order->link, *std::move(tile));
  } else if (auto progress = work.progress()) {
    wire::NodeReport report;
    *report.mutable_progress() = *std::move(progress);
    send(order->link, std::move(report));
  }
  if (work.is_done()) {
    end_block(*order, "");
  } else if (order->cancelled) {
    end_block(*order, "cancelled");
  }
  return cpu_seconds;
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
