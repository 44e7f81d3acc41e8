// SPDX-License-Identifier: Apache-2.0
// HeadState's dealings with nodes.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/text.h"
#include "common/wire/convert.h"
#include "renderfarm/governor/front_file.h"
#include "renderfarm/head/head_state.h"

namespace cyclorama {
namespace {

constexpr std::uint32_t kMostThreads = 4096;

Error broken(const std::string& what) { return Error(ErrorCode::kInvalidArgument, what); }

std::string to_text(const Node& node) { return fmt::format("node '{}'", printable(node.name)); }

bool is_same_scene(const wire::SceneDescription& a, const wire::SceneDescription& b) {
  return a.title() == b.title() && a.triangles_seen() == b.triangles_seen() &&
         a.triangles_stored() == b.triangles_stored();
}

/// Nothing for a tile that no picture can have.
std::optional<PixelRect> rect_of(const wire::Tile& tile) {
  constexpr std::uint32_t kFar = 1 << 20;
  if (std::max({tile.x_px(), tile.y_px(), tile.width_px(), tile.height_px()}) > kFar) return std::nullopt;
  return PixelRect{static_cast<int>(tile.x_px()), static_cast<int>(tile.y_px()), static_cast<int>(tile.width_px()),
                   static_cast<int>(tile.height_px())};
}

}  // namespace

void HeadState::node_came(NodeId id) {
  if (nodes_.size() >= limits_.nodes) {
    peers_.end_node(id, Error(ErrorCode::kBusy, fmt::format("this head takes {} nodes and has them", limits_.nodes)));
    return;
  }
  Node node;
  node.arrived_at = clock_.now();
  node.heard_at = clock_.now();
  nodes_.emplace(id, std::move(node));
}

void HeadState::node_reported(NodeId id, wire::NodeReport report) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end()) return;
  Node& node = found->second;
  node.heard_at = clock_.now();
  node.late = false;
  Status fine = Done{};
  if (report.has_hello() == (node.threads > 0.0)) {
    fine = broken("a node must say hello first, and once");
  } else if (report.has_hello()) {
    fine = hello(id, node, report.hello());
  } else if (report.has_scene_loaded()) {
    fine = scene_loaded(node, report.scene_loaded());
  } else if (report.has_tile()) {
    fine = tile_came(id, node, *report.mutable_tile());
  } else if (report.has_end()) {
    fine = block_ended(id, node, report.end());
  } else {
    fine = broken("a message of unknown kind");
  }
  if (fine) return;
  peers_.notice(fmt::format("{} is sent away: {}", to_text(node), fine.error().message()));
  peers_.end_node(id, fine.error());
  node_gone(id);
}

Status HeadState::hello(NodeId id, Node& node, const wire::Hello& hello) {
  if (hello.version() != CYCLORAMA_VERSION) {
    return broken(fmt::format("this head is version {}, the node is '{}'; install the same on both", CYCLORAMA_VERSION,
                              printable(hello.version())));
  }
  if (hello.threads() < 1 || hello.threads() > kMostThreads) {
    return broken(fmt::format("hello.threads is {}; it must be 1 to {}", hello.threads(), kMostThreads));
  }
  node.name = printable(hello.name());
  node.threads = hello.threads();
  for (const FarmScene& scene : scenes_) {
    node.scenes[scene.name] = {};
    wire::NodeCommand command;
    command.mutable_load_scene()->set_scene(scene.name);
    command.mutable_load_scene()->set_path(scene.path);
    peers_.to_node(id, command);
  }
  peers_.notice(fmt::format("{} came, with {} threads", to_text(node), hello.threads()));
  return Done{};
}

Status HeadState::scene_loaded(Node& node, const wire::SceneLoaded& loaded) {
  const auto asked = node.scenes.find(loaded.scene());
  if (asked == node.scenes.end() || asked->second.state != Node::SceneState::kLoading) {
    return broken(fmt::format("it loaded scene '{}', which nobody asked for", printable(loaded.scene())));
  }
  if (!loaded.error().empty()) {
    constexpr std::size_t kLongestError = 500;
    asked->second = {Node::SceneState::kFailed, printable(loaded.error(), kLongestError)};
    peers_.notice(fmt::format("{} cannot load scene '{}': {}", to_text(node), loaded.scene(), asked->second.error));
    return Done{};
  }
  TRY(validate(loaded.description()));
  if (loaded.description().name() != loaded.scene()) return broken("a scene's description has another name");
  const bool is_first = nodes_with(loaded.scene()) == 0;
  wire::SceneDescription& known = descriptions_[loaded.scene()];
  if (is_first) {
    known = loaded.description();
    TRY(keep_front(loaded));
  } else if (!is_same_scene(known, loaded.description())) {
    // Pictures would be patched together from two scenes.
    asked->second = {Node::SceneState::kFailed, "its copy differs from the other nodes'"};
    peers_.notice(
        fmt::format("{} has another scene '{}' than the other nodes: copy it anew; not used for it until then",
                    to_text(node), loaded.scene()));
    return Done{};
  }
  asked->second.state = Node::SceneState::kLoaded;
  peers_.notice(fmt::format("{} has scene '{}': {:.1f} M triangles, {:.2f} GiB, loaded in {:.1f} s", to_text(node),
                            loaded.scene(), 1e-6 * static_cast<double>(loaded.description().triangles_seen()),
                            static_cast<double>(loaded.memory_bytes()) / (1 << 30), loaded.load_seconds()));
  return Done{};
}

Status HeadState::keep_front(const wire::SceneLoaded& loaded) {
  fronts_.erase(loaded.scene());
  if (loaded.front().empty()) return Done{};
  TRY_ASSIGN(const Front front, parse_front(loaded.front(), "front.toml"));
  fronts_.emplace(loaded.scene(), front);
  return Done{};
}

Status HeadState::tile_came(NodeId, Node& node, wire::BlockTile& message) {
  const auto place = node.blocks.find(message.block());
  if (place == node.blocks.end())
    return broken(fmt::format("it sent a tile of block {}, not its own", message.block()));
  FrameInFlight* const frame = find_frame(place->second);
  if (frame == nullptr || frame->failure) return Done{};  // Nobody wants it any more.
  wire::Tile& tile = *message.mutable_tile();
  const auto rect = rect_of(tile);
  const bool belongs = rect && !tile.jpeg().empty() && tile.view_number() == frame->view.number();
  const auto verdict = belongs ? frame->assembly.accept(message.block(), *rect) : FrameAssembly::Verdict::kForeign;
  if (verdict == FrameAssembly::Verdict::kForeign) {
    return broken(fmt::format("it sent a tile that is not in block {}", message.block()));
  }
  if (verdict == FrameAssembly::Verdict::kDuplicate) return Done{};
  const SessionId id = place->second.session;
  Session& session = sessions_.at(id);
  frame->bytes += tile.jpeg().size();
  frame->last_tile_at = clock_.now();
  session.bytes_waiting += tile.jpeg().size();
  if (frame->begun) {
    relay(id, session, std::move(tile));
  } else {
    frame->held.push_back(std::move(tile));
  }
  if (session.bytes_waiting > limits_.session_bytes) {
    fail(*frame, "the museum takes pictures more slowly than they are made, or they are too large", session);
  }
  advance(id);
  return Done{};
}

Status HeadState::block_ended(NodeId id, Node& node, const wire::BlockEnd& end) {
  const auto found = node.blocks.find(end.block());
  if (found == node.blocks.end()) return broken(fmt::format("it ended block {}, not its own", end.block()));
  const BlockPlace place = found->second;
  node.blocks.erase(found);
  FrameInFlight* const frame = find_frame(place);
  if (frame == nullptr || frame->failure) return Done{};
  Session& session = sessions_.at(place.session);
  frame->assembly.end(end.block(), end);
  const std::vector<PixelRect> orphans = frame->assembly.give_up(end.block());
  if (!orphans.empty()) {
    peers_.notice(fmt::format("{} did not finish a block: {}; others take over", to_text(node),
                              end.error().empty() ? "it gave no reason" : printable(end.error(), 200)));
    give_again(place.session, session, *frame, orphans, id);
  }
  advance(place.session);
  return Done{};
}

void HeadState::node_gone(NodeId id) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end()) return;
  const Node node = std::move(found->second);
  nodes_.erase(found);  // First, so that its blocks are not given to it again.
  if (node.threads > 0.0) peers_.notice(fmt::format("{} is gone; {} left", to_text(node), nodes_.size()));
  lose_blocks(node.blocks);
}

void HeadState::lose_blocks(const std::map<std::uint64_t, BlockPlace>& blocks) {
  std::set<SessionId> touched;
  for (const auto& [block, place] : blocks) {
    FrameInFlight* const frame = find_frame(place);
    if (frame == nullptr || frame->failure) continue;
    give_again(place.session, sessions_.at(place.session), *frame, frame->assembly.give_up(block), NodeId{});
    touched.insert(place.session);
  }
  for (const SessionId id : touched) advance(id);
}

void HeadState::tick_nodes() {
  std::vector<NodeId> silent;
  for (const auto& [id, node] : nodes_) {
    if (node.threads <= 0.0 && clock_.now() - node.arrived_at > limits_.silence) silent.push_back(id);
  }
  for (const NodeId id : silent) {
    peers_.end_node(id, broken("it did not say hello in time"));
    node_gone(id);
  }
}

}  // namespace cyclorama
