// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/scene_load_worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/file.h"
#include "common/base/text.h"
#include "renderfarm/light/light_file.h"
#include "renderfarm/node/coordinator_files.h"
#include "renderfarm/node/retry.h"
#include "renderfarm/scene_distribution/sha256.h"

namespace cyclorama::node {
namespace {
constexpr std::size_t kMaxWaiting = 4096;
/// Maximum size of an order: enough for names, paths, and the names of all scenes of a large farm.
constexpr std::size_t kMaxOrderBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxErrorBytes = 1000;
constexpr std::uint64_t kMaxPieceBytes = std::uint64_t{1} << 30;
}  // namespace

Status SceneLoadWorker::take(std::shared_ptr<NodeLink> link, const wire::NodeCommand& order) {
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
  if (next.order.has_load_scene()) *report.mutable_scene_loaded() = load(*next.link, next.order.load_scene());
  if (next.order.has_use_light()) use_light(*next.link, next.order.use_light());
  if (next.order.has_send_light()) send_light(*next.link, next.order.send_light());
  if (next.order.has_use_piece()) use_piece(*next.link, next.order.use_piece());
  if (next.order.has_send_piece()) send_piece(*next.link, next.order.send_piece());
  loading_ = false;
  // If the link was closed during the load, load() may have recorded its names afterwards, so they are forgotten again.
  if (next.link->is_closed()) scenes_.forget_link(next.link->id());
  if (report.has_scene_loaded()) send_report_(next.link->id(), std::move(report));
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

Result<VersionedLight> SceneLoadWorker::light_of(const NodeLink& link, const wire::UseLight& order,
                                                 BlockRenderer& renderer) {
  constexpr std::uint64_t kMaxLightBytes = std::uint64_t{4} << 30;
  const LightVersions* const known = renderer.light_versions();
  if (auto here = known == nullptr ? std::nullopt : known->find(order.light().version())) return *std::move(here);
  if (link.files() == nullptr || !scene_distribution::is_sha256(order.light().version())) {
    return Error(ErrorCode::kBadData, "the coordinator named no light that it could send");
  }
  if (order.light().bytes() > kMaxLightBytes) return Error(ErrorCode::kBadData, "the coordinator's light is too large");
  const std::function<bool()> cancelled = [&] { return link.is_closed() || is_stopping(); };
  CoordinatorFiles coordinator(link.files(), cancelled);
  TRY_ASSIGN(const std::vector<std::byte> file,
             retried([&] { return coordinator.whole(order.light().version(), order.light().bytes()); },
                     [&](const Error& error) { set_state("fetching light: " + error.message() + "; trying again"); },
                     cancelled));
  TRY_ASSIGN(VersionedLight light, renderer.add_light(file, "light of scene '" + printable(order.scene()) + "'"));
  // Without a copy, the light is fetched again after the node's next start.
  if (const auto copy = lights_.prepare(scenes_.path_of(link.id(), order.scene()))) {
    if (const Status written = write_file_atomically(*copy, file); !written) set_state(written.error().message());
  }
  return light;
}

void SceneLoadWorker::use_light(const NodeLink& link, const wire::UseLight& order) {
  const std::shared_ptr<BlockRenderer> renderer = scenes_.find(link.id(), order.scene());
  if (renderer == nullptr) return;  // The scene was dropped, which was reported to the coordinator.
  set_state(fmt::format("fetching the light of scene '{}'", printable(order.scene())));
  const Result<VersionedLight> light = light_of(link, order, *renderer);
  if (light) computing_.forget(scenes_.path_of(link.id(), order.scene()));
  for (auto& [to, sent] : scenes_.light_reports(scenes_.path_of(link.id(), order.scene()), light)) {
    wire::NodeReport report;
    *report.mutable_scene_light() = std::move(sent);
    send_report_(to, std::move(report));
  }
  set_state(light ? fmt::format("scene '{}' has light", printable(order.scene()))
                  : fmt::format("scene '{}' has no light: {}", printable(order.scene()), light.error().message()));
}

void SceneLoadWorker::send_light(const NodeLink& link, const wire::SendLight& order) {
  const std::shared_ptr<BlockRenderer> renderer = scenes_.find(link.id(), order.scene());
  if (renderer == nullptr || renderer->light_versions() == nullptr || link.files() == nullptr) return;
  const auto light = renderer->light_versions()->find(order.light().version());
  if (!light) return;  // A newer version replaced this one, which was reported to the coordinator.
  const std::function<bool()> cancelled = [&] { return link.is_closed() || is_stopping(); };
  const Status sent =
      CoordinatorFiles(link.files(), cancelled).store_light(light->version, light::light_file_bytes(*light->store));
  if (!sent) set_state(fmt::format("sending the light of scene '{}': {}", order.scene(), sent.error().message()));
}

void SceneLoadWorker::use_piece(const NodeLink& link, const wire::LightPieceOrder& order) {
  const std::string path = scenes_.path_of(link.id(), order.scene());
  const std::filesystem::path file = computing_.piece_file(path, order.stage(), order.piece().piece());
  const wire::LightVersion& version = order.piece().file();
  if (file.empty() || link.files() == nullptr || !scene_distribution::is_sha256(version.version())) return;
  const std::function<bool()> cancelled = [&] { return link.is_closed() || is_stopping(); };
  const auto bytes = CoordinatorFiles(link.files(), cancelled)
                         .whole(version.version(), std::min<std::uint64_t>(version.bytes(), kMaxPieceBytes));
  std::error_code none;
  std::filesystem::create_directories(file.parent_path(), none);
  // If it fails, the coordinator gives the same order again after a while.
  const Status written = bytes ? write_file_atomically(file, *bytes) : Status(bytes.error());
  if (!written) return set_state("fetching a piece of light: " + written.error().message());
  computing_.fetched(path, order.stage(), order.piece().piece());
}

void SceneLoadWorker::send_piece(const NodeLink& link, const wire::LightPieceOrder& order) {
  const std::filesystem::path file =
      computing_.piece_file(scenes_.path_of(link.id(), order.scene()), order.stage(), order.piece().piece());
  if (file.empty() || link.files() == nullptr) return;
  const auto mapped = MappedFile::open(file);
  if (!mapped) return set_state("sending a piece of light: " + mapped.error().message());
  const std::function<bool()> cancelled = [&] { return link.is_closed() || is_stopping(); };
  const Status sent =
      CoordinatorFiles(link.files(), cancelled).store_light(order.piece().file().version(), mapped->bytes());
  if (!sent) set_state("sending a piece of light: " + sent.error().message());
}

}  // namespace cyclorama::node
