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

/// Finds the scenes that a node is told to load: on its own disk, or, where the coordinator hands them out, in the node's
/// cache, after fetching what that lacks. Thread-bound.
class SceneFetcher {
 public:
  /// A cache without a folder is none.
  explicit SceneFetcher(scene_distribution::SceneCacheOptions cache) : options_(std::move(cache)) {}

  /// Where an order's scene was found last, not held; nothing for what comes from the node's own disk.
  [[nodiscard]] std::optional<scene_distribution::SceneCache::Held> found_before(const wire::LoadScene& order) const;

  /// `coordinator` should be a connection of its own, or null if it hands nothing out. `tell` gets sentences for people;
  /// `cancelled` is asked often, from a thread of the call's own as well. While the coordinator cannot be reached, or is busy,
  /// it tries again until cancelled. Blocks.
  ///
  /// kUnavailable  cancelled. Else as SceneCache::bring(), and what the coordinator answers: a sentence that names scene, file
  /// and remedy.
  Result<scene_distribution::SceneCache::Held> find(const wire::LoadScene& order,
                                                    const std::shared_ptr<grpc::Channel>& coordinator,
                                                    const std::function<void(std::string)>& report_progress,
                                                    const std::function<bool()>& cancelled);

 private:
  const scene_distribution::SceneCacheOptions options_;
  std::optional<scene_distribution::SceneCache> cache_;  ///< Once it was needed.
  std::map<std::string, std::filesystem::path> found_;   ///< By digest.
};

}  // namespace cyclorama::node
