// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/result.h"
#include "renderfarm/node/light_worker.h"
#include "renderfarm/node/node_link.h"
#include "renderfarm/node/scene_fetcher.h"
#include "renderfarm/node/scene_store.h"

namespace cyclorama::node {

/// Loads the scenes that coordinators order, and fetches or sends their light, one after another, while blocks of
/// others are rendered; pieces of light, too. Orders come from any thread; the work is done by the caller of wait() and
/// work(), always the same thread. Keeps references to the scenes and to the light worker, which must outlive it.
class SceneLoadWorker {
 public:
  /// Sends a report to a coordinator; does nothing if its stream has ended.
  using ReportSink = std::function<void(LinkId, wire::NodeReport)>;
  /// `cache` as in SceneFetcher.
  SceneLoadWorker(SceneStore& scenes, LightWorker& computing, scene_distribution::SceneCacheOptions cache,
                  ReportSink send_report)
      : scenes_(scenes),
        computing_(computing),
        lights_(cache.folder),
        fetcher_(std::move(cache)),
        send_report_(std::move(send_report)) {}

  // Thread-safe:

  /// Takes LoadScene and all commands that send or fetch files. Errors: kBadData if too many orders wait or the message
  /// is huge: the coordinator is broken.
  Status take(std::shared_ptr<NodeLink> link, const wire::NodeCommand& order);
  [[nodiscard]] bool is_loading() const { return loading_; }
  /// Returns a sentence on the scene that is being loaded or was loaded last; empty before the first.
  [[nodiscard]] std::string state() const;
  /// Ends wait(), and aborts fetching. A load cannot be aborted.
  void stop();

  // For the load thread only:

  /// Waits for an order. Returns false once stopped.
  bool wait();
  /// Executes one order and replies. Returns false if no order waits.
  bool work();

 private:
  struct Waiting {
    std::shared_ptr<NodeLink> link;
    wire::NodeCommand order;
  };
  /// Finds the scene. Fetches it if the coordinator distributes it and it is not in memory.
  Result<scene_distribution::SceneCache::Held> find(const NodeLink& link, const wire::LoadScene& order);
  [[nodiscard]] bool is_stopping() const;
  wire::SceneLoaded load(const NodeLink& link, const wire::LoadScene& order);
  /// Fetches the light unless the node has it, and adds it to the scene. Writes a copy to the node's cache, for its
  /// next start.
  Result<VersionedLight> light_of(const NodeLink& link, const wire::UseLight& order, BlockRenderer& renderer);
  void use_light(const NodeLink& link, const wire::UseLight& order);
  void send_light(const NodeLink& link, const wire::SendLight& order);
  void use_piece(const NodeLink& link, const wire::LightPieceOrder& order);
  void send_piece(const NodeLink& link, const wire::LightPieceOrder& order);
  void set_state(std::string sentence);

  SceneStore& scenes_;
  LightWorker& computing_;
  const LightFiles lights_;
  SceneFetcher fetcher_;  ///< Load thread only.
  const ReportSink send_report_;
  std::atomic<bool> loading_ = false;

  mutable std::mutex mutex_;  ///< Guards the following.
  std::condition_variable changed_;
  bool stopping_ = false;
  std::deque<Waiting> waiting_;
  std::string state_;
};

}  // namespace cyclorama::node
