// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/node_link.h"

namespace cyclorama {
namespace {
/// Enough that rendering never waits for an encoder that keeps up; few, so that a slow network stops the rays.
constexpr std::size_t kMostOutgoing = 4;
/// As many as the tiles of the largest picture, which a head may send one by one after it lost a node.
constexpr std::size_t kMostOrders = 8192;
}  // namespace

bool NodeLink::take_order(const wire::RenderBlock& block) {
  auto order = std::make_shared<BlockOrder>();
  order->block = block;
  const std::lock_guard lock(mutex_);
  return orders_.size() < kMostOrders && orders_.emplace(block.block(), std::move(order)).second;
}

void NodeLink::cancel(std::uint64_t block) {
  const std::lock_guard lock(mutex_);
  if (const auto found = orders_.find(block); found != orders_.end()) found->second->cancelled = true;
}

std::shared_ptr<const BlockOrder> NodeLink::order(std::uint64_t block) const {
  const std::lock_guard lock(mutex_);
  const auto found = orders_.find(block);
  return found == orders_.end() ? nullptr : found->second;
}

void NodeLink::forget(std::uint64_t block) {
  const std::lock_guard lock(mutex_);
  orders_.erase(block);
}

bool NodeLink::push(Outgoing item) {
  {
    std::unique_lock lock(mutex_);
    // No deadline of its own: the stream's keep-alive closes the link when the head is gone.
    changed_.wait(lock, [this] { return closed_ || outgoing_.size() < kMostOutgoing; });
    if (closed_) return false;
    outgoing_.push_back(std::move(item));
  }
  changed_.notify_all();
  return true;
}

std::optional<NodeLink::Outgoing> NodeLink::pop() {
  std::optional<Outgoing> item;
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !outgoing_.empty(); });
    if (closed_) return std::nullopt;
    item = std::move(outgoing_.front());
    outgoing_.pop_front();
  }
  changed_.notify_all();
  return item;
}

void NodeLink::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

}  // namespace cyclorama
