// SPDX-License-Identifier: Apache-2.0
// Handling of nodes' messages.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/text.h"
#include "common/wire/convert.h"
#include "common/wire/payload.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "renderfarm/governor/pareto_front_file.h"

namespace cyclorama::coordinator {
namespace {

constexpr std::uint32_t kMaxThreads = 4096;

Error broken(const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); }

std::string to_text(const Node& node) { return fmt::format("node '{}'", printable(node.name)); }
NoticeAbout about(const Node& node) { return {.node = node.name}; }
NoticeAbout trouble_with(const Node& node) { return {.node = node.name, .is_trouble = true}; }

bool is_same_scene(const wire::SceneDescription& a, const wire::SceneDescription& b) {
  return a.title() == b.title() && a.triangles_seen() == b.triangles_seen() &&
         a.triangles_stored() == b.triangles_stored();
}

/// Checks everything about a tile except that it belongs to its block.
Status check_tile(const wire::Tile& tile, const wire::View& view) {
  if (tile.view_number() != view.number()) return broken("it is of another view");
  if (tile.jpeg().empty()) return broken("it is empty");
  if (!tile.depth().empty() && !view.depth()) return broken("it has depth, which its view does not request");
  return validate(tile, static_cast<int>(view.panorama().width_px()), static_cast<int>(view.panorama().height_px()));
}

/// Precondition: check_tile() accepted the tile.
PixelRect rect_of(const wire::Tile& tile) {
  return {static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px()), static_cast<int>(tile.width_px()),
          static_cast<int>(tile.height_px())};
}

}  // namespace

void CoordinatorState::node_connected(NodeId id) {
  if (nodes_.size() >= limits_.nodes) {
    delegate_.end_node(
        id, Error(ErrorCode::kBusy,
                  fmt::format("this coordinator accepts {} nodes, and that many are connected", limits_.nodes)));
    return;
  }
  nodes_.add(id, clock_.now());
}

void CoordinatorState::node_reported(NodeId id, wire::NodeReport report) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end()) return;
  Node& node = found->second;
  if (report.has_tile() || report.has_end()) {
    node.worked_at = clock_.now();
    node.late_for.clear();
  }
  Status fine = Done{};
  if (report.has_hello() == (node.threads > 0.0)) {
    fine = broken("a node must say hello first, and once");
  } else if (report.has_hello()) {
    fine = hello(id, node, report.hello());
  } else if (report.has_scene_loaded()) {
    fine = scene_loaded(node, report.scene_loaded());
  } else if (report.has_tile()) {
    fine = tile_received(id, node, *report.mutable_tile());
  } else if (report.has_end()) {
    fine = block_ended(id, node, report.end());
  } else if (report.has_progress()) {
    fine = block_progressed(node, report.progress());
  } else if (report.has_status()) {
    status_received(node, report.status());
  } else if (report.has_scene_dropped()) {
    fine = scene_dropped(node, report.scene_dropped());
  } else if (report.has_scene_light()) {
    fine = scene_light(id, node, report.scene_light());
  } else if (report.has_light_pieces()) {
    fine = light_pieces(id, node, report.light_pieces());
  } else {
    fine = broken("a message of unknown kind");
  }
  if (fine) return;
  delegate_.notice(fmt::format("{} is rejected: {}", to_text(node), fine.error().message()), trouble_with(node));
  delegate_.end_node(id, fine.error());
  node_disconnected(id);
}

Status CoordinatorState::hello(NodeId id, Node& node, const wire::Hello& hello) {
  if (hello.version() != CYCLORAMA_VERSION) {
    return broken(fmt::format("this coordinator is version {}, the node is '{}'; install the same on both",
                              CYCLORAMA_VERSION, printable(hello.version())));
  }
  if (hello.threads() < 1 || hello.threads() > kMaxThreads) {
    return broken(fmt::format("hello.threads is {}; it must be 1 to {}", hello.threads(), kMaxThreads));
  }
  node.name = printable(hello.name());
  node.threads = hello.threads();
  accounts_.set_threads(nodes_.capacity());
  // Scenes in use come first; a later scene never replaces an earlier one.
  std::vector<FarmScene> order = scenes_;
  std::set<std::string> keep = scenes_in_use();
  std::stable_partition(order.begin(), order.end(), [&](const FarmScene& scene) { return keep.contains(scene.name); });
  for (const FarmScene& scene : order) {
    keep.insert(scene.name);
    order_scene(id, node, scene, keep);
  }
  delegate_.notice(fmt::format("{} came, with {} threads", to_text(node), hello.threads()), about(node));
  return Done{};
}

void CoordinatorState::order_scene(NodeId id, Node& node, const FarmScene& scene, const std::set<std::string>& keep) {
  if (!scene.is_ready()) return;  // scene_read() orders the scene later.
  node.scenes[scene.name] = {};
  node.scenes[scene.name].asked_at = clock_.now();
  wire::NodeCommand command;
  command.mutable_load_scene()->set_scene(scene.name);
  if (scene.on_coordinator) {
    command.mutable_load_scene()->set_digest(scene.digest);
  } else {
    command.mutable_load_scene()->set_path(scene.path);
  }
  for (const std::string& name : keep) command.mutable_load_scene()->add_in_use(name);
  delegate_.to_node(id, command);
}

void CoordinatorState::scene_read(const std::string& scene, const std::string& digest) {
  const auto known = std::ranges::find(scenes_, scene, &FarmScene::name);
  CHECK(known != scenes_.end() && known->on_coordinator && known->digest.empty());
  known->digest = digest;
  for (auto& [id, node] : nodes_) {
    if (node.threads <= 0.0) continue;
    std::set<std::string> keep = scenes_in_use();
    for (const auto& [name, ordered] : node.scenes) keep.insert(name);
    order_scene(id, node, *known, keep);
  }
}

void CoordinatorState::order_scene_anew(const std::string& name) {
  constexpr auto kRetryDelay = std::chrono::seconds(10);
  const auto scene = std::ranges::find(scenes_, name, &FarmScene::name);
  for (auto& [id, node] : nodes_) {
    const auto known = node.scenes.find(name);
    if (known == node.scenes.end()) continue;
    const bool is_dropped = known->second.state == Node::SceneState::kDropped;
    const bool has_failed = known->second.state == Node::SceneState::kFailed;
    if (is_dropped || (has_failed && clock_.now() - known->second.asked_at > kRetryDelay)) {
      order_scene(id, node, *scene, scenes_in_use());
    }
  }
}

std::set<std::string> CoordinatorState::scenes_in_use() const {
  std::set<std::string> names;
  for (const auto& [id, session] : sessions_) {
    if (!session.scene.empty()) names.insert(session.scene);
  }
  return names;
}

void CoordinatorState::status_received(Node& node, const wire::NodeStatus& status) {
  if (status.draining() && !node.status.draining()) {
    delegate_.notice(fmt::format("{} is about to stop; it gets no more blocks", to_text(node)), about(node));
  }
  node.status = status;
}

Status CoordinatorState::scene_dropped(Node& node, const wire::SceneDropped& dropped) {
  const auto known = node.scenes.find(dropped.scene());
  if (known == node.scenes.end()) {
    return broken(fmt::format("it dropped scene '{}', which it was never ordered to load", printable(dropped.scene())));
  }
  if (known->second.state == Node::SceneState::kLoaded) {
    known->second.state = Node::SceneState::kDropped;
    follow_light(dropped.scene());
    delegate_.notice(fmt::format("{} dropped scene '{}': its memory is short", to_text(node), dropped.scene()),
                     about(node));
  }
  return Done{};
}

Status CoordinatorState::scene_loaded(Node& node, const wire::SceneLoaded& loaded) {
  const auto asked = node.scenes.find(loaded.scene());
  if (asked == node.scenes.end() || asked->second.state != Node::SceneState::kLoading) {
    return broken(fmt::format("it loaded scene '{}', which nobody requested", printable(loaded.scene())));
  }
  if (!loaded.error().empty()) {
    constexpr std::size_t kMaxErrorBytes = 500;
    asked->second.state = Node::SceneState::kFailed;
    asked->second.error = printable(loaded.error(), kMaxErrorBytes);
    delegate_.notice(fmt::format("{} cannot load scene '{}': {}", to_text(node), loaded.scene(), asked->second.error),
                     trouble_with(node));
    return Done{};
  }
  TRY(validate(loaded.description()));
  if (loaded.description().name() != loaded.scene()) return broken("a scene's description has another name");
  asked->second.memory_bytes = loaded.memory_bytes();
  const bool is_first = nodes_with(loaded.scene()) == 0;
  wire::SceneDescription& known = descriptions_[loaded.scene()];
  if (is_first) {
    known = loaded.description();
    TRY(keep_pareto_front(loaded));
  } else if (!is_same_scene(known, loaded.description())) {
    // Without this check, a picture could be composed of two different scenes.
    asked->second.state = Node::SceneState::kFailed;
    asked->second.error = "its copy differs from the other nodes'";
    delegate_.notice(
        fmt::format("{} has another scene '{}' than the other nodes: copy it again; it is not used until then",
                    to_text(node), loaded.scene()),
        trouble_with(node));
    return Done{};
  }
  if (!loaded.note().empty()) {
    delegate_.notice(fmt::format("{}, scene '{}': {}", to_text(node), loaded.scene(), printable(loaded.note())),
                     about(node));
  }
  if (loaded.has_light()) TRY(add_light(loaded.light(), &asked->second));
  asked->second.can_compute_light = loaded.can_compute_light();
  asked->second.state = Node::SceneState::kLoaded;
  asked->second.speed = speeds_.relative(loaded);
  delegate_.notice(fmt::format("{} has scene '{}': {:.1f} M triangles, {:.2f} GiB, loaded in {:.1f} s", to_text(node),
                               loaded.scene(), 1e-6 * static_cast<double>(loaded.description().triangles_seen()),
                               static_cast<double>(loaded.memory_bytes()) / (1 << 30), loaded.load_seconds()),
                   about(node));
  follow_light(loaded.scene());
  return Done{};
}

Status CoordinatorState::keep_pareto_front(const wire::SceneLoaded& loaded) {
  pareto_fronts_.erase(loaded.scene());
  bounces_.erase(loaded.scene());
  if (loaded.has_bounces()) {
    TRY(render::check_knob("bounces", loaded.bounces(), 0, render::kMaxBounces));
    bounces_.emplace(loaded.scene(), static_cast<int>(loaded.bounces()));
  }
  if (loaded.front().empty()) return Done{};
  TRY_ASSIGN(const governor::ParetoFront front,
             governor::parse_pareto_front(loaded.front(), governor::kParetoFrontFileName));
  pareto_fronts_.emplace(loaded.scene(), front);
  return Done{};
}

Status CoordinatorState::tile_received(NodeId, Node& node, wire::BlockTile& message) {
  const auto place = node.blocks.find(message.block());
  if (place == node.blocks.end())
    return broken(fmt::format("it sent a tile of block {}, not its own", message.block()));
  FrameInFlight* const frame = find_frame(place->second);
  if (frame == nullptr || frame->failure) return Done{};  // The tile is no longer wanted.
  wire::Tile& tile = *message.mutable_tile();
  if (const Status usable = check_tile(tile, frame->view); !usable) {
    return broken(fmt::format("it sent a tile of block {}: {}", message.block(), usable.error().message()));
  }
  const auto verdict = frame->assembly.accept(message.block(), rect_of(tile));
  if (verdict == FrameAssembly::Verdict::kForeign) {
    return broken(fmt::format("it sent a tile that is not in block {}", message.block()));
  }
  if (verdict == FrameAssembly::Verdict::kDuplicate) return Done{};
  const SessionId id = place->second.session;
  Session& session = sessions_.at(id);
  frame->bytes += payload_bytes(tile);
  frame->last_tile_at = clock_.now();
  session.bytes_waiting += payload_bytes(tile);
  if (frame->begun) {
    relay(id, session, std::move(tile));
  } else {
    frame->held.push_back(std::move(tile));
  }
  if (session.bytes_waiting > limits_.session_bytes) {
    fail(*frame, "the museum receives pictures more slowly than the farm renders them, or they are too large", session);
  }
  advance(id);
  return Done{};
}

Status CoordinatorState::block_ended(NodeId id, Node& node, const wire::BlockEnd& end) {
  const auto found = node.blocks.find(end.block());
  if (found == node.blocks.end()) return broken(fmt::format("it ended block {}, not its own", end.block()));
  BlockLocation place = found->second;
  node.blocks.erase(found);
  const auto account = node.accounts.find({place.account, place.work});
  if (--account->second.blocks == 0) node.accounts.erase(account);
  NodeSpeeds::learn(&node, end, clock_.now());
  charge(&place, measured_seconds(end.render_cpu_seconds()) + measured_seconds(end.encode_cpu_seconds()));
  FrameInFlight* const frame = find_frame(place);
  if (frame == nullptr || frame->failure) return Done{};
  Session& session = sessions_.at(place.session);
  frame->assembly.end(end.block(), end);
  const std::vector<PixelRect> orphans = frame->assembly.give_up(end.block());
  if (!orphans.empty()) {
    delegate_.notice(fmt::format("{} did not finish a block: {}; other nodes take over", to_text(node),
                                 end.error().empty() ? "it gave no reason" : printable(end.error(), 200)),
                     trouble_with(node));
    reassign(place.session, session, *frame, orphans, id);
  }
  move_block_to_idle(place.session, session, *frame, id);
  advance(place.session);
  watch(place.session);
  return Done{};
}

Status CoordinatorState::block_progressed(Node& node, const wire::BlockProgress& progress) {
  const auto found = node.blocks.find(progress.block());
  if (found == node.blocks.end()) return broken(fmt::format("it reports block {}, not its own", progress.block()));
  charge(&found->second, measured_seconds(progress.render_cpu_seconds()));
  return Done{};
}

void CoordinatorState::charge(BlockLocation* place, double cpu_seconds) {
  const double more = cpu_seconds - place->charged_seconds;
  if (!(more > 0.0)) return;
  place->charged_seconds = cpu_seconds;
  accounts_.charge(place->account, place->work, more, clock_.now());
  if (FrameInFlight* const frame = find_frame(*place)) frame->charged_seconds += more;
}

void CoordinatorState::node_disconnected(NodeId id) {
  const std::optional<Node> removed = nodes_.remove(id);  // First, so that its blocks are not reassigned to it.
  if (!removed) return;
  const Node& node = *removed;
  placement_.forget(id);
  accounts_.set_threads(nodes_.capacity());
  if (node.threads > 0.0)
    delegate_.notice(fmt::format("{} is gone; {} left", to_text(node), nodes_.size()), trouble_with(node));
  for (const auto& [name, scene] : node.scenes) follow_light(name);
  lose_blocks(node.blocks, id);
}

void CoordinatorState::tick_nodes() {
  std::vector<NodeId> silent;
  for (const auto& [id, node] : nodes_) {
    if (node.threads <= 0.0 && clock_.now() - node.arrived_at > limits_.silence) silent.push_back(id);
  }
  for (const NodeId id : silent) {
    delegate_.end_node(id, broken("it did not say hello in time"));
    node_disconnected(id);
  }
}

}  // namespace cyclorama::coordinator
