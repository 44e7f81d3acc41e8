// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>

#include "common/base/clock.h"
#include "renderfarm/node/render_worker.h"
#include "renderfarm/node/scene_load_worker.h"
#include "renderfarm/node/scene_store.h"

namespace cyclorama::node {

/// A node without its threads and its network: what coordinators may order, and what the node owes them. Every message of a
/// coordinator passes take(), which believes nothing.
///
///   stream ──open()──► take() ──LoadScene──► loads ─┐
///                        └────RenderBlock──► renders ┴──► NodeLink ──► stream
///
/// Thread-safe, apart from the desks' work() and wait().
class NodeController {
 public:
  /// `memory_limit_bytes`: for scenes and films together; a quarter of it, but no more than 1 GiB, is the films'.
  /// 0: scenes are not limited. `cache` as SceneFetcher.
  NodeController(SceneLoader loader, std::uint64_t memory_limit_bytes,
                 scene_distribution::SceneCacheOptions cache = {});

  /// A stream to a coordinator has begun. It lasts until close(). `files` as NodeLink.
  std::shared_ptr<NodeLink> open(std::shared_ptr<grpc::Channel> files = nullptr);
  /// kBadData  the coordinator is broken: end the stream.
  Status take(const std::shared_ptr<NodeLink>& link, const wire::NodeCommand& command);
  /// The stream has ended: its blocks are given up, and the scenes stay.
  void close(NodeLink& link);

  [[nodiscard]] wire::NodeReport status() const;
  /// From now on coordinators hear that the node wants no new blocks; those it has are rendered all the same.
  void drain();

  [[nodiscard]] SceneLoadWorker& loads() { return loads_; }
  [[nodiscard]] RenderWorker& renders() { return renders_; }
  [[nodiscard]] const SceneLoadWorker& loads() const { return loads_; }
  [[nodiscard]] const RenderWorker& renders() const { return renders_; }

 private:
  void send_report(LinkId link, wire::NodeReport report);

  const TimePoint begun_;
  SceneStore scenes_;
  RenderWorker renders_;
  SceneLoadWorker loads_;
  std::atomic<bool> draining_ = false;

  std::mutex mutex_;  ///< Guards the following.
  LinkId opened_ = 0;
  std::map<LinkId, std::shared_ptr<NodeLink>> links_;
};

}  // namespace cyclorama::node
