// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/node_controller.h"

#include <algorithm>
#include <utility>

#include "common/base/file.h"
#include "renderfarm/node/resident_memory.h"

namespace cyclorama::node {
namespace {

constexpr std::uint64_t kMaxFilmBytes = std::uint64_t{1} << 30;

std::uint64_t film_bytes(std::uint64_t memory_limit_bytes) {
  return memory_limit_bytes == 0 ? kMaxFilmBytes : std::min(kMaxFilmBytes, memory_limit_bytes / 4);
}

}  // namespace

NodeController::NodeController(SceneLoader loader, std::uint64_t memory_limit_bytes,
                               scene_distribution::SceneCacheOptions cache, LightStarter light,
                               std::shared_ptr<render::Crew> crew)
    : begun_(clock_.now()),
      scenes_(std::move(loader), memory_limit_bytes == 0 ? 0 : memory_limit_bytes - film_bytes(memory_limit_bytes),
              LightFiles(cache.folder), light != nullptr),
      renders_(scenes_, film_bytes(memory_limit_bytes), std::move(crew)),
      lights_(std::move(light), LightFiles(cache.folder),
              {[this] { return renders_.waiting() > 0; }, [this](const std::string& path) { return scenes_.has(path); },
               [this](const std::string& path, const wire::LightPieces& pieces) { light_progressed(path, pieces); },
               [this](const std::string& path, const std::filesystem::path& file, const Status& status) {
                 light_computed(path, file, status);
               }},
              clock_),
      loads_(scenes_, lights_, std::move(cache),
             [this](LinkId link, wire::NodeReport report) { send_report(link, std::move(report)); }) {}

std::shared_ptr<NodeLink> NodeController::open(std::shared_ptr<grpc::Channel> files) {
  std::shared_ptr<NodeLink> link;
  {
    const std::lock_guard lock(mutex_);
    link = std::make_shared<NodeLink>(++opened_, std::move(files), renders_.crew().threads());
    links_.emplace(link->id(), link);
  }
  renders_.open(link);
  return link;
}

Status NodeController::take(const std::shared_ptr<NodeLink>& link, const wire::NodeCommand& command) {
  if (command.has_load_scene() || command.has_use_light() || command.has_send_light() || command.has_send_piece() ||
      command.has_use_piece()) {
    return loads_.take(link, command);
  }
  light_ordered(*link, command);
  if (command.has_render()) {
    lights_.give_way();
    return renders_.take(link->id(), command.render());
  }
  if (command.has_cancel()) renders_.cancel(link->id(), command.cancel().block());
  if (command.has_forget_session()) renders_.forget_session({link->id(), command.forget_session().session()});
  return Done{};
}

void NodeController::light_ordered(const NodeLink& link, const wire::NodeCommand& command) {
  if (command.has_compute_pieces()) {
    const wire::ComputePieces& order = command.compute_pieces();
    lights_.compute(scenes_.path_of(link.id(), order.scene()), order);
  }
  if (!command.has_compute_light()) return;
  const std::string& scene = command.compute_light().scene();
  const std::string path = scenes_.path_of(link.id(), scene);
  if (path.empty()) return;
  lights_.want(path, scene);
  if (const auto stage = lights_.stage_of(path)) light_progressed(path, *stage);
}

void NodeController::light_progressed(const std::string& path, const wire::LightPieces& pieces) {
  for (const SceneStore::Name& name : scenes_.names_of(path)) {
    wire::NodeReport report;
    *report.mutable_light_pieces() = pieces;
    report.mutable_light_pieces()->set_scene(name.scene);
    send_report(name.link, std::move(report));
  }
}

void NodeController::close(NodeLink& link) {
  link.close();
  {
    const std::lock_guard lock(mutex_);
    links_.erase(link.id());
  }
  renders_.drop(link.id());
  scenes_.forget_link(link.id());
}

wire::NodeReport NodeController::status() const {
  wire::NodeReport report;
  wire::NodeStatus* const status = report.mutable_status();
  status->set_memory_bytes(resident_memory_bytes());
  status->set_blocks_waiting(static_cast<std::uint32_t>(renders_.waiting()));
  status->set_uptime_s(to_seconds(SteadyClock().now() - begun_));
  status->set_draining(draining_);
  lights_.report(status);
  return report;
}

void NodeController::drain() {
  draining_ = true;
  const wire::NodeReport report = status();
  const std::lock_guard lock(mutex_);
  for (const auto& [id, link] : links_) link->push(report);
}

void NodeController::send_report(LinkId link, wire::NodeReport report) {
  const std::lock_guard lock(mutex_);
  if (const auto found = links_.find(link); found != links_.end()) found->second->push(std::move(report));
}

void NodeController::light_computed(const std::string& path, const std::filesystem::path& file, const Status& status) {
  const std::shared_ptr<BlockRenderer> renderer = scenes_.at_path(path);
  if (renderer == nullptr) return;  // The scene was unloaded meanwhile; its next load reads the file.
  const auto added = [&]() -> Result<VersionedLight> {
    TRY(status);
    TRY_ASSIGN(const MappedFile mapped, MappedFile::open(file));
    return renderer->add_light(mapped.bytes(), file.string());
  };
  for (auto& [link, light] : scenes_.light_reports(path, added())) {
    wire::NodeReport report;
    *report.mutable_scene_light() = std::move(light);
    send_report(link, std::move(report));
  }
}

}  // namespace cyclorama::node
