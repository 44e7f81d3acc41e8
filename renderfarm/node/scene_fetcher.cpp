// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_fetcher.h"

#include <fmt/format.h>

#include "common/base/text.h"
#include "renderfarm/node/coordinator_files.h"
#include "renderfarm/node/retry.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::node {
std::optional<scene_distribution::SceneCache::Held> SceneFetcher::found_before(const wire::LoadScene& order) const {
  const auto known = found_.find(order.digest());
  if (!order.path().empty() || known == found_.end()) return std::nullopt;
  scene_distribution::SceneCache::Held found;
  found.path = known->second;
  return found;
}

Result<scene_distribution::SceneCache::Held> SceneFetcher::find(const wire::LoadScene& order,
                                                                const std::shared_ptr<grpc::Channel>& coordinator,
                                                                const std::function<void(std::string)>& report_progress,
                                                                const std::function<bool()>& cancelled) {
  if (!order.path().empty()) {
    scene_distribution::SceneCache::Held on_disk;
    on_disk.path = order.path();
    return on_disk;
  }
  if (coordinator == nullptr || !scene_distribution::is_sha256(order.digest()))
    return Error(ErrorCode::kBadData, "the coordinator gave neither a path nor a digest");
  if (options_.folder.empty()) {
    return Error(ErrorCode::kInvalidArgument,
                 "the coordinator distributes this scene, and this node has no cache for it; write "
                 "'cache' in node.toml, or --cache FOLDER");
  }
  if (!cache_) {
    TRY_ASSIGN(cache_, scene_distribution::SceneCache::open(options_));
  }
  CoordinatorFiles source(coordinator, cancelled);
  const std::string scene = printable(order.scene());
  const auto progress = [&](const char* doing, double fraction) {
    report_progress(fmt::format("{} scene '{}': {:.0f} %", doing, scene, 100.0 * fraction));
    return !cancelled();
  };
  auto held = retried(
      [&] {
        const auto files = source.list(order.digest());
        return files ? cache_->bring(*files, source, progress) : Error(files.error());
      },
      [&](const Error& error) {
        report_progress(fmt::format("fetching scene '{}': {}; trying again", scene, error.message()));
      },
      cancelled);
  if (held) found_[order.digest()] = held->path;
  return held;
}

}  // namespace cyclorama::node
