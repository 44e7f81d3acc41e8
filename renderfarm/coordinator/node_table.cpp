// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/node_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/text.h"

namespace cyclorama::coordinator {

std::string title_of(const Node& node) { return fmt::format("node '{}'", printable(node.name)); }

std::string short_version(const std::string& version) {
  constexpr std::size_t kDigits = 8;
  return version.substr(0, kDigits);
}

bool Node::has_light(const std::string& scene, const std::string& version) const {
  const auto known = scenes.find(scene);
  return has(scene) &&
         std::ranges::find(known->second.light, version, &wire::LightVersion::version) != known->second.light.end();
}

void NodeTable::add(NodeId id, TimePoint now) {
  Node node;
  node.arrived_at = now;
  node.worked_at = now;
  nodes_.emplace(id, std::move(node));
}

std::optional<Node> NodeTable::remove(NodeId id) {
  auto removed = nodes_.extract(id);
  if (removed.empty()) return std::nullopt;
  return std::move(removed.mapped());
}

std::size_t NodeTable::count_with(const std::string& scene) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(nodes_, [&](const auto& entry) { return entry.second.has(scene); }));
}

std::size_t NodeTable::count_with_light(const std::string& scene, const std::string& version) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(nodes_, [&](const auto& entry) { return entry.second.has_light(scene, version); }));
}

std::uint64_t NodeTable::memory_of(const std::string& scene) const {
  std::uint64_t max = 0;
  for (const auto& [id, node] : nodes_) {
    if (node.has(scene)) max = std::max(max, node.scenes.at(scene).memory_bytes);
  }
  return max;
}

std::vector<NodeId> NodeTable::able(const std::string& scene, AccountId account, const std::string& light,
                                    NodeId not_to) const {
  std::vector<NodeId> all;
  std::vector<NodeId> prompt;
  for (const auto& [id, node] : nodes_) {
    if (!node.has(scene) || id == not_to || (!light.empty() && !node.has_light(scene, light))) continue;
    all.push_back(id);
    if (!node.is_late(account) && !node.status.draining()) prompt.push_back(id);
  }
  return prompt.empty() ? all : prompt;
}

NodeId NodeTable::least_loaded(const std::vector<NodeId>& nodes) const {
  return *std::ranges::min_element(nodes, {}, [&](NodeId id) {
    const Node& node = nodes_.at(id);
    return static_cast<double>(node.blocks.size()) / node.threads;
  });
}

double NodeTable::threads_of(const std::set<NodeId>& nodes) const {
  double threads = 0.0;
  for (const NodeId id : nodes) threads += nodes_.at(id).threads;
  return threads;
}

double NodeTable::capacity() const {
  double threads = 0.0;
  for (const auto& [id, node] : nodes_) threads += node.threads * node.utilisation;
  return threads;
}

}  // namespace cyclorama::coordinator
