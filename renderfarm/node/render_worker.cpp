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

/// Returns a lane's order among the crew's pictures. Tiles are encoded before, with order 0, since a node of one thread
/// would otherwise encode none until a block's piece ends.
std::uint64_t order_of(const BlockLanes::Lane& lane) { return lane.place + 1; }

/// Counts for its lifetime.
class Counted {
 public:
  explicit Counted(std::atomic<int>& count) : count_(count) { ++count_; }
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::atomic<int>& count_;
};

}  // namespace

RenderWorker::RenderWorker(SceneStore& scenes, std::size_t max_film_bytes, std::shared_ptr<render::Crew> crew)
    : scenes_(scenes), films_(max_film_bytes), crew_(std::move(crew)), lanes_(lanes_for(crew_->threads())) {
  for (std::size_t lane = 0; lane < lanes_.lanes().size(); ++lane) running_.push_back(std::make_unique<Running>());
}

void RenderWorker::open(std::shared_ptr<NodeLink> link) {
  const std::lock_guard lock(mutex_);
  const LinkId id = link->id();
  links_.emplace(id, std::move(link));
}

void RenderWorker::drop(LinkId link) {
  {
    const std::lock_guard lock(mutex_);
    links_.erase(link);
    lanes_.queue().drop(link);
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
    if (!lanes_.queue().add(std::move(order))) {
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
    lanes_.queue().cancel(link, block);
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
  return lanes_.queue().size();
}

bool RenderWorker::wait_until_idle(TimePoint deadline, Duration quiet) {
  const auto has_work = [this] { return lanes_.queue().size() > 0; };
  std::unique_lock lock(mutex_);
  for (;;) {
    if (!changed_.wait_until(lock, deadline, [&] { return !has_work(); })) return false;
    const TimePoint until = SteadyClock().now() + quiet;
    if (!changed_.wait_until(lock, std::min(until, deadline), has_work)) return until <= deadline;
  }
}

bool RenderWorker::has_moved_since(TimePoint since) const {
  return rendering_ == 0 || TimePoint(Duration(moved_at_.load())) >= since;
}

void RenderWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
}

RenderQueue::May RenderWorker::takes_tiles() const {
  return [this](const BlockOrder& order) {
    const auto found = links_.find(order.link);
    return found == links_.end() || found->second->takes_tiles();
  };
}

std::shared_ptr<const BlockOrder> RenderWorker::next() const { return lanes_.next(takes_tiles()); }

void RenderWorker::look_again() {
  lanes_.update(takes_tiles());
  for (std::size_t i = 0; i < running_.size(); ++i) {
    const BlockLanes::Lane& lane = lanes_.lanes()[i];
    Running& running = *running_[i];
    running.is_preempted = lane.is_preempted;
    running.ends_at = lane.ends_at.time_since_epoch().count();
    if (running.picture) running.picture->set_order(order_of(lane));
  }
}

double RenderWorker::rendered_seconds() const {
  return rendered_seconds_ + (busy_lanes_ == 0 ? 0.0 : to_seconds(SteadyClock().now() - busy_since_));
}

bool RenderWorker::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock,
                [this] { return stopping_ || !ended_sessions_.empty() || !dropped_.empty() || next() != nullptr; });
  return !stopping_;
}

bool RenderWorker::work(std::size_t lane) {
  const auto order = begin_piece(lane);
  if (order == nullptr) return false;
  end_piece(lane, advance(lane, order));
  return true;
}

std::shared_ptr<const BlockOrder> RenderWorker::begin_piece(std::size_t lane) {
  const std::lock_guard lock(mutex_);
  for (const FilmStore::Session& session : std::exchange(ended_sessions_, {})) films_.forget(session);
  for (const LinkId link : std::exchange(dropped_, {})) {
    films_.forget_link(link);
    std::erase_if(begun_, [&](const auto& begun) {
      return begun.second.work.order().link == link && !lanes_.is_in_work(*begun.first);
    });
  }
  const TimePoint now = SteadyClock().now();
  const auto order = lanes_.begin(lane, now, takes_tiles());
  if (order == nullptr) return nullptr;
  if (busy_lanes_++ == 0) busy_since_ = now;
  running_[lane]->picture.emplace(*crew_, order_of(lanes_.lanes()[lane]));
  look_again();
  return order;
}

void RenderWorker::end_piece(std::size_t lane, double cpu_seconds) {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<const BlockOrder> order = lanes_.lanes()[lane].order;
  running_[lane]->picture.reset();
  if (busy_lanes_ == 1) rendered_seconds_ = rendered_seconds();
  --busy_lanes_;
  lanes_.end(lane, SteadyClock().now(), cpu_seconds);
  if (!lanes_.queue().has(*order)) begun_.erase(order.get());  // Its link was dropped meanwhile.
  look_again();
  changed_.notify_all();  // The block can go on in any lane.
}

double RenderWorker::advance(std::size_t lane, const std::shared_ptr<const BlockOrder>& order) {
  if (order->cancelled) {
    end_block(*order, "cancelled");
    return 0.0;
  }
  try {
    return render_piece(lane, order);
  } catch (const std::bad_alloc&) {
    end_block(*order, "this node has not enough memory for the block");
    return 0.0;
  }
}

RenderWorker::Begun* RenderWorker::begun_of(const std::shared_ptr<const BlockOrder>& order) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = begun_.find(order.get()); found != begun_.end()) return &found->second;
  }
  auto work = BlockWork::begin(order);
  if (!work) {
    end_block(*order, work.error().message());
    return nullptr;
  }
  if (!order->block.keep()) films_.forget({order->link, order->block.session()});
  const std::lock_guard lock(mutex_);
  return &begun_.emplace(order.get(), Begun{*std::move(work)}).first->second;
}

double RenderWorker::render_piece(std::size_t lane, const std::shared_ptr<const BlockOrder>& order) {
  Begun* const begun = begun_of(order);
  if (begun == nullptr) return 0.0;
  BlockWork& work = begun->work;
  Running& running = *running_[lane];
  const render::RenderCost before = {.cpu_seconds = work.cost().cpu_seconds, .wall_seconds = work.cost().wall_seconds};
  const BlockWork::Interrupts interrupts{[&] { return stopping_ || order->cancelled; },
                                         [&] {
                                           const Duration::rep now = SteadyClock().now().time_since_epoch().count();
                                           moved_at_ = now;
                                           return running.is_preempted || now >= running.ends_at;
                                         }};
  moved_at_ = SteadyClock().now().time_since_epoch().count();
  std::vector<RenderedTile> tiles;
  {
    const Counted counted(rendering_);
    tiles = work.next_tiles(films_, *crew_, interrupts);
  }
  const double cpu_seconds = work.cost().cpu_seconds - before.cpu_seconds;
  begun->wall_seconds += (work.cost().wall_seconds - before.wall_seconds) * running.picture->share();
  {
    const std::lock_guard lock(mutex_);
    lanes_.queue().serve(order->link, order->block.block(), cpu_seconds);
  }
  const bool has_tiles = !tiles.empty();
  for (RenderedTile& tile : tiles) send(order->link, std::move(tile));
  if (auto progress = has_tiles ? std::nullopt : work.progress()) {
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
  const auto begun = [&] {
    const std::lock_guard lock(mutex_);
    return begun_.extract(&order);
  }();
  if (begun) {
    end.cost = begun.mapped().work.cost();
    end.cost.wall_seconds = begun.mapped().wall_seconds;
    const std::lock_guard lock(mutex_);
    end.waited_seconds = std::max(0.0, rendered_seconds() - order.rendered_before - end.cost.wall_seconds);
  }
  send(order.link, std::move(end));
  {
    const std::lock_guard lock(mutex_);
    lanes_.queue().remove(order.link, order.block.block());
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
