// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_fetcher.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/clock.h"
#include "common/base/text.h"
#include "renderfarm/node/coordinator_files.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::node {
namespace {

constexpr Duration kFirstRetry = std::chrono::milliseconds(100);
constexpr Duration kMaxRetryDelay = std::chrono::seconds(2);
constexpr Duration kLook = std::chrono::milliseconds(50);

bool may_pass(const Error& error) {
  return error.code() == ErrorCode::kUnavailable || error.code() == ErrorCode::kTimedOut ||
         error.code() == ErrorCode::kBusy;
}

/// Returns false if cancelled meanwhile.
bool wait(Duration delay, const std::function<bool()>& cancelled) {
  const SteadyClock clock;
  const TimePoint end = clock.now() + delay;
  while (clock.now() < end && !cancelled()) clock.wait_until(std::min(end, clock.now() + kLook));
  return !cancelled();
}

}  // namespace

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
  for (Duration delay = kFirstRetry;; delay = std::min(2 * delay, kMaxRetryDelay)) {
    const auto files = source.list(order.digest());
    auto held = files ? cache_->bring(*files, source, progress) : Error(files.error());
    if (held) found_[order.digest()] = held->path;
    if (held || !may_pass(held.error())) return held;
    report_progress(fmt::format("fetching scene '{}': {}; trying again", scene, held.error().message()));
    if (!wait(delay, cancelled))
      return Error(ErrorCode::kUnavailable, "given up: the coordinator is gone, or no longer needs the scene");
  }
}

}  // namespace cyclorama::node
