// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>

#include "common/base/clock.h"
#include "renderfarm/node/load_desk.h"
#include "renderfarm/node/render_desk.h"
#include "renderfarm/node/scene_store.h"

namespace cyclorama {

/// A node without its threads and its network: what heads may order, and what the node owes them. Every message of a
/// head passes take(), which believes nothing.
///
///   stream ──open()──► take() ──LoadScene──► loads ─┐
///                        └────RenderBlock──► renders ┴──► NodeLink ──► stream
///
/// Thread-safe, apart from the desks' work() and wait().
class NodeDesk {
 public:
  /// `memory_limit_bytes`: for scenes and films together; a quarter of it, but no more than 1 GiB, is the films'.
  /// 0: scenes are not limited. `cache` as SceneFetcher.
  NodeDesk(SceneLoader loader, std::uint64_t memory_limit_bytes, SceneCacheOptions cache = {});

  /// A stream to a head has begun. It lasts until close(). `files` as NodeLink.
  std::shared_ptr<NodeLink> open(std::shared_ptr<grpc::Channel> files = nullptr);
  /// kBadData  the head is broken: end the stream.
  Status take(const std::shared_ptr<NodeLink>& link, const wire::NodeCommand& command);
  /// The stream has ended: its blocks are given up, and the scenes stay.
  void close(NodeLink& link);

  [[nodiscard]] wire::NodeReport status() const;
  /// From now on heads hear that the node wants no new blocks; those it has are rendered all the same.
  void drain();

  [[nodiscard]] LoadDesk& loads() { return loads_; }
  [[nodiscard]] RenderDesk& renders() { return renders_; }
  [[nodiscard]] const LoadDesk& loads() const { return loads_; }
  [[nodiscard]] const RenderDesk& renders() const { return renders_; }

 private:
  void tell(LinkId link, wire::NodeReport report);

  const TimePoint begun_;
  SceneStore scenes_;
  RenderDesk renders_;
  LoadDesk loads_;
  std::atomic<bool> draining_ = false;

  std::mutex mutex_;  ///< Guards the following.
  LinkId opened_ = 0;
  std::map<LinkId, std::shared_ptr<NodeLink>> links_;
};

}  // namespace cyclorama
