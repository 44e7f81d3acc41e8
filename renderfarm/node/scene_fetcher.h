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

/// Finds the scenes that a node is ordered to load: on its own disk, or, if the coordinator distributes them, in the
/// node's cache, after fetching missing files. Thread-bound.
class SceneFetcher {
 public:
  /// A cache without a folder is disabled.
  explicit SceneFetcher(scene_distribution::SceneCacheOptions cache) : options_(std::move(cache)) {}

  /// Returns where an order's scene was last found; nothing keeps it there. Returns nothing for scenes on the node's
  /// own disk.
  [[nodiscard]] std::optional<scene_distribution::SceneCache::Held> found_before(const wire::LoadScene& order) const;

  /// `coordinator` should be a separate connection, or null if it distributes nothing. `report_progress` receives
  /// sentences for the operator. `cancelled` is called often, also from a thread of the call. While the coordinator is
  /// unreachable or busy, the call retries until cancelled. Blocks.
  ///
  /// Errors: kUnavailable if cancelled; else as SceneCache::bring(), or the coordinator's error: a sentence that names
  /// scene, file and remedy.
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
