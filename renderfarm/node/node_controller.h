// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>

#include "common/base/clock.h"
#include "renderfarm/node/light_worker.h"
#include "renderfarm/node/render_worker.h"
#include "renderfarm/node/scene_load_worker.h"
#include "renderfarm/node/scene_store.h"

namespace cyclorama::node {

/// A node without its threads and its network: executes the commands of coordinators and collects the replies. Every
/// message from a coordinator passes through take(), which validates it.
///
///   stream ──open()──► take() ──LoadScene──► loads ─┬──────────────► NodeLink ──► stream
///                        ├─light, pieces─► lights ─┘
///                        └────RenderBlock──► renders ──► NodeLink ──► stream
///
/// Thread-safe, except the workers' work() and wait().
class NodeController {
 public:
  /// `memory_limit_bytes` limits scenes and films together; a quarter of it, at most 1 GiB, is for films. 0: scenes are
  /// not limited. See SceneFetcher for `cache`. Without `light`, the node computes no light. The scenes that `loader`
  /// loads use the crew, too.
  NodeController(SceneLoader loader, std::uint64_t memory_limit_bytes, scene_distribution::SceneCacheOptions cache = {},
                 LightStarter light = nullptr, std::shared_ptr<render::Crew> crew = std::make_shared<render::Crew>(1));

  /// Begins a stream to a coordinator; it lasts until close(). See NodeLink for `files`.
  std::shared_ptr<NodeLink> open(std::shared_ptr<grpc::Channel> files = nullptr);
  /// Executes a command. Errors: kBadData if the coordinator violates the protocol; the caller then ends the stream.
  Status take(const std::shared_ptr<NodeLink>& link, const wire::NodeCommand& command);
  /// Ends a stream. Its blocks are abandoned; the scenes stay loaded.
  void close(NodeLink& link);

  [[nodiscard]] wire::NodeReport status() const;
  /// Makes status() report from now on that the node is draining. Blocks that the node has are still rendered.
  void drain();

  [[nodiscard]] SceneLoadWorker& loads() { return loads_; }
  [[nodiscard]] RenderWorker& renders() { return renders_; }
  [[nodiscard]] LightWorker& lights() { return lights_; }
  [[nodiscard]] const SceneLoadWorker& loads() const { return loads_; }
  [[nodiscard]] const RenderWorker& renders() const { return renders_; }

 private:
  void send_report(LinkId link, wire::NodeReport report);
  void light_ordered(const NodeLink& link, const wire::NodeCommand& command);
  void light_progressed(const std::string& path, const wire::LightPieces& pieces);
  void light_computed(const std::string& path, const std::filesystem::path& file, const Status& status);

  const SteadyClock clock_;
  const TimePoint begun_;
  SceneStore scenes_;
  RenderWorker renders_;
  LightWorker lights_;
  SceneLoadWorker loads_;
  std::atomic<bool> draining_ = false;

  std::mutex mutex_;  ///< Guards the following.
  LinkId opened_ = 0;
  std::map<LinkId, std::shared_ptr<NodeLink>> links_;
};

}  // namespace cyclorama::node
