// SPDX-License-Identifier: Apache-2.0
// The part of CoordinatorState that reports to monitoring.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/text.h"
#include "renderfarm/coordinator/coordinator_state.h"

namespace cyclorama::coordinator {
namespace {

std::string state_of(const Node& node) {
  const auto any = [&](Node::SceneState state) {
    return std::ranges::any_of(node.scenes, [state](const auto& entry) { return entry.second.state == state; });
  };
  if (node.status.draining()) return "stops";
  if (!node.late_for.empty()) return "late";
  if (any(Node::SceneState::kLoaded)) return "ready";
  return any(Node::SceneState::kLoading) ? "loading" : "no scene";
}

/// Returns the light that a node has, and its reports on the light that it computes. Returns at most a few entries,
/// because a node may report anything.
std::vector<std::string> light_of(const Node& node) {
  constexpr std::size_t kMaxEntries = 8;
  constexpr double kMaxMinutes = 100'000.0;
  std::vector<std::string> entries;
  for (const auto& [name, scene] : node.scenes) {
    if (!node.has(name) || scene.light.empty() || entries.size() == kMaxEntries) continue;
    entries.push_back(fmt::format("{}: {}", name, short_version(scene.light.front().version())));
  }
  for (const wire::LightProgress& light : node.status.light()) {
    if (entries.size() == kMaxEntries) break;
    const double share = light.done_share() >= 0.0 ? std::min(light.done_share(), 1.0) : 0.0;
    std::string entry = fmt::format("{}: {:.0f} %", printable(light.scene()), 100.0 * share);
    const double minutes = std::ceil(light.seconds_left() / 60.0);
    if (minutes > 0.0 && minutes < kMaxMinutes) entry += fmt::format(", {:.0f} min left", minutes);
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

std::string CoordinatorState::museum_of(SessionId id) const {
  const Session* const session = sessions_.find(id);
  return session == nullptr ? "" : session->museum;
}

watch::FarmOverview CoordinatorState::overview() const {
  watch::FarmOverview farm;
  for (const FarmScene& scene : catalogue_.all()) farm.scene_nodes[scene.name] = nodes_with(scene.name);
  for (const auto& [id, session] : sessions_) {
    if (session.scene.empty()) continue;
    watch::WatchedSession& watched = farm.sessions.emplace_back();
    watched.id = static_cast<std::uint64_t>(id);
    watched.museum = session.museum;
    watched.scene = session.scene;
    watched.light = lights_.summary(session.scene);
    watched.budget_ms = session.governed ? session.governed->governor.budget_ms() : 0.0;
  }
  for (const auto& [id, node] : nodes_) {
    if (node.threads <= 0.0) continue;
    watch::WatchedNode& watched = farm.nodes.emplace_back();
    watched.id = static_cast<std::uint64_t>(id);
    watched.name = node.name;
    watched.state = state_of(node);
    watched.threads = static_cast<int>(node.threads);
    watched.blocks = node.blocks.size();
    watched.blocks_waiting = node.status.blocks_waiting();
    watched.memory_bytes = node.status.memory_bytes();
    watched.uptime_s = node.status.uptime_s();
    watched.light = light_of(node);
    for (const auto& [name, scene] : node.scenes) {
      if (scene.state != Node::SceneState::kLoaded) continue;
      if (watched.scenes.empty()) watched.speed = scene.speed;
      watched.scenes.push_back(name);
    }
  }
  return farm;
}

}  // namespace cyclorama::coordinator
