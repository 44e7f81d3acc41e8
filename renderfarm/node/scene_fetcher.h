// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/scene_distribution/scene_cache.h"

namespace grpc {
class Channel;
}  // namespace grpc

namespace cyclorama::node {

/// Finds the scenes that a node is ordered to load. They are on the node's disk or, if the coordinator distributes
/// them, in the node's cache; missing files are fetched. Thread-bound.
class SceneFetcher {
 public:
  /// A cache without a folder is disabled.
  explicit SceneFetcher(scene_distribution::SceneCacheOptions cache) : options_(std::move(cache)) {}

  /// Returns where the order's distributed scene was last found. It may have been removed since. Returns nothing for
  /// scenes that are not distributed.
  [[nodiscard]] std::optional<scene_distribution::SceneCache::Held> found_before(const wire::LoadScene& order) const;

  /// Finds the scene of an order. `coordinator` is the connection for files; null if the coordinator distributes
  /// nothing. It should not be the connection for work, so that frames need not wait for files. `report_progress`
  /// receives sentences for the operator. `cancelled` is called often, also from another thread. While the coordinator
  /// is unreachable or busy, the call retries until cancelled. Blocks.
  ///
  /// Errors: kUnavailable if cancelled; otherwise those of SceneCache::bring(), or the coordinator's error. Each is a
  /// sentence with scene, file and remedy.
  Result<scene_distribution::SceneCache::Held> find(const wire::LoadScene& order,
                                                    const std::shared_ptr<grpc::Channel>& coordinator,
                                                    const std::function<void(std::string)>& report_progress,
                                                    const std::function<bool()>& cancelled);

 private:
  const scene_distribution::SceneCacheOptions options_;
  std::optional<scene_distribution::SceneCache> cache_;  ///< Opened at the first use.
  std::map<std::string, std::filesystem::path> found_;   ///< Paths by digest.
};

}  // namespace cyclorama::node
