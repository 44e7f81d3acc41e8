// SPDX-License-Identifier: Apache-2.0
// Dispatches nodes' messages.
#include <fmt/format.h>

#include <utility>

#include "common/base/text.h"
#include "renderfarm/coordinator/coordinator_state.h"

namespace cyclorama::coordinator {
namespace {

constexpr std::uint32_t kMaxThreads = 4096;

NoticeAbout trouble_with(const Node& node) { return {.node = node.name, .is_trouble = true}; }

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
  const Status fine = dispatch(id, node, report);
  if (fine) return;
  delegate_.notice(fmt::format("{} is rejected: {}", title_of(node), fine.error().message()), trouble_with(node));
  delegate_.end_node(id, fine.error());
  node_disconnected(id);
}

Status CoordinatorState::dispatch(NodeId id, Node& node, wire::NodeReport& report) {
  if (report.has_hello() == (node.threads > 0.0)) return broken("a node must say hello first, and once");
  if (report.has_hello()) return hello(id, node, report.hello());
  if (report.has_scene_loaded()) return scene_orders_.loaded(node, report.scene_loaded());
  if (report.has_tile()) return scheduler_.tile_received(node, *report.mutable_tile());
  if (report.has_end()) return scheduler_.block_ended(id, node, report.end());
  if (report.has_progress()) return scheduler_.block_progressed(node, report.progress());
  if (report.has_scene_dropped()) return scene_orders_.dropped(node, report.scene_dropped());
  if (report.has_scene_light()) return lights_.light_reported(id, node, report.scene_light());
  if (report.has_light_pieces()) return lights_.pieces_reported(id, node, report.light_pieces());
  if (!report.has_status()) return broken("a message of unknown kind");
  if (report.status().draining() && !node.status.draining()) {
    delegate_.notice(fmt::format("{} is about to stop; it gets no more blocks", title_of(node)), {.node = node.name});
  }
  node.status = report.status();
  return Done{};
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
  scene_orders_.order_all(id, node);
  delegate_.notice(fmt::format("{} came, with {} threads", title_of(node), hello.threads()), {.node = node.name});
  return Done{};
}

void CoordinatorState::node_disconnected(NodeId id) {
  const std::optional<Node> removed = nodes_.remove(id);  // First, so that its blocks are not reassigned to it.
  if (!removed) return;
  const Node& node = *removed;
  placement_.forget(id);
  accounts_.set_threads(nodes_.capacity());
  if (node.threads > 0.0)
    delegate_.notice(fmt::format("{} is gone; {} left", title_of(node), nodes_.size()), trouble_with(node));
  for (const auto& [name, scene] : node.scenes) lights_.follow(name);
  scheduler_.lose(node.blocks, id);
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
