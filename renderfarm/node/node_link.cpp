// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/node_link.h"

#include <algorithm>
#include <utility>

namespace cyclorama::node {
namespace {
/// Least of the maximum number of queued items: enough that rendering never waits for an encoder that keeps up, and few
/// enough that a slow network suspends rendering. Many threads render and encode many tiles at a time.
constexpr int kMinMaxOutgoing = 4;
}  // namespace

NodeLink::NodeLink(LinkId id, std::shared_ptr<grpc::Channel> files, int threads)
    : id_(id),
      files_(std::move(files)),
      max_outgoing_(static_cast<std::size_t>(std::max(kMinMaxOutgoing, threads / 2))) {}

void NodeLink::push(Outgoing item) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || finishing_) return;
    outgoing_.push_back(std::move(item));
  }
  changed_.notify_all();
}

bool NodeLink::takes_tiles() const {
  const std::lock_guard lock(mutex_);
  return outgoing_.size() < max_outgoing_;
}

std::optional<NodeLink::Outgoing> NodeLink::pop(TimePoint deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [this] { return closed_ || finishing_ || !outgoing_.empty(); });
  if (closed_ || outgoing_.empty()) return std::nullopt;
  Outgoing item = std::move(outgoing_.front());
  outgoing_.pop_front();
  return item;
}

void NodeLink::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  changed_.notify_all();
}

void NodeLink::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    outgoing_.clear();
  }
  changed_.notify_all();
}

bool NodeLink::is_finished() const {
  const std::lock_guard lock(mutex_);
  return closed_ || (finishing_ && outgoing_.empty());
}

}  // namespace cyclorama::node
