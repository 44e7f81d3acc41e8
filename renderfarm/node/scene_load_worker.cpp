// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_load_worker.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "common/base/text.h"

namespace cyclorama::node {
namespace {
constexpr std::size_t kMaxWaiting = 4096;
/// Enough for names, paths, and the names of all scenes of a large farm.
constexpr std::size_t kMaxOrderBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxErrorBytes = 1000;
}  // namespace

Status SceneLoadWorker::take(std::shared_ptr<NodeLink> link, const wire::LoadScene& order) {
  if (order.ByteSizeLong() > kMaxOrderBytes)
    return Error(ErrorCode::kBadData, "the coordinator sent a load of many bytes");
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kMaxWaiting)
      return Error(ErrorCode::kBadData, "the coordinator sent too many loads at once");
    waiting_.push_back({std::move(link), order});
  }
  changed_.notify_all();
  return Done{};
}

std::string SceneLoadWorker::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void SceneLoadWorker::set_state(std::string sentence) {
  const std::lock_guard lock(mutex_);
  state_ = std::move(sentence);
}

void SceneLoadWorker::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
}

bool SceneLoadWorker::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
  return !stopping_;
}

bool SceneLoadWorker::work() {
  Waiting next;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return false;
    next = std::move(waiting_.front());
    waiting_.pop_front();
  }
  if (next.link->is_closed()) return true;
  loading_ = true;
  wire::NodeReport report;
  *report.mutable_scene_loaded() = load(*next.link, next.order);
  loading_ = false;
  // If the link closed during the load, its names must be forgotten here.
  if (next.link->is_closed()) scenes_.forget_link(next.link->id());
  send_report_(next.link->id(), std::move(report));
  return true;
}

bool SceneLoadWorker::is_stopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

Result<scene_distribution::SceneCache::Held> SceneLoadWorker::find(const NodeLink& link, const wire::LoadScene& order) {
  if (auto known = fetcher_.found_before(order); known && scenes_.has(known->path.string())) return *std::move(known);
  return fetcher_.find(
      order, link.files(), [this](std::string sentence) { set_state(std::move(sentence)); },
      [&] { return link.is_closed() || is_stopping(); });
}

wire::SceneLoaded SceneLoadWorker::load(const NodeLink& link, const wire::LoadScene& order) {
  const std::string name = printable(order.scene());
  set_state(fmt::format("loading scene '{}'", name));
  wire::SceneLoaded loaded;
  std::vector<SceneStore::Name> left;
  if (const auto found = find(link, order)) {
    const auto progress = [&](double fraction) {
      set_state(fmt::format("loading scene '{}': {:.0f} %", name, 100.0 * fraction));
    };
    loaded = scenes_.load(link.id(), order, found->path.string(), progress, &left);
    if (loaded.error().empty()) loaded_(found->path.string(), name);
  } else {
    loaded.set_scene(order.scene());
    loaded.set_error(printable(found.error().message(), kMaxErrorBytes));  // The message may quote the coordinator.
  }
  for (const SceneStore::Name& scene : left) {
    wire::NodeReport report;
    report.mutable_scene_dropped()->set_scene(scene.scene);
    send_report_(scene.link, std::move(report));
  }
  set_state(loaded.error().empty()
                ? fmt::format("scene '{}' of {:.1f} M triangles loaded in {:.1f} s", name,
                              1e-6 * static_cast<double>(loaded.description().triangles_seen()), loaded.load_seconds())
                : fmt::format("cannot load scene '{}': {}", name, loaded.error()));
  return loaded;
}

}  // namespace cyclorama::node
