// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/node_speeds.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cyclorama::coordinator {
namespace {

/// A node counts as slowed if its utilisation is below this fraction of the other nodes'.
constexpr double kSlowed = 0.5;
/// A slowed node that was not measured for this long, for lack of blocks, is assumed to be kRecovery times as fast: it
/// may have recovered, and its small share of blocks will show.
constexpr Duration kForgotten = std::chrono::seconds(1);
constexpr double kRecovery = 1.5;
constexpr double kRemembered = 0.5;

}  // namespace

double NodeSpeeds::relative(const wire::SceneLoaded& loaded) {
  // Probes vary with the other load of a host; hosts of the same kind should count as equally fast.
  constexpr double kAlike = 0.12;
  constexpr double kMaxSpeedRatio = 100.0;
  const double seconds = loaded.probe_cpu_seconds();
  if (!std::isfinite(seconds) || seconds <= 0.0) return 1.0;
  const double speed = probes_.emplace(loaded.scene(), seconds).first->second / seconds;
  return std::abs(speed - 1.0) <= kAlike ? 1.0 : std::clamp(speed, 1.0 / kMaxSpeedRatio, kMaxSpeedRatio);
}

void NodeSpeeds::learn(Node* node, const wire::BlockEnd& end, TimePoint now) {
  constexpr double kKept = 0.9;
  constexpr double kMaxSeconds = 1e6;
  const double possible = end.wall_seconds() * node->threads;
  const double used = end.render_cpu_seconds();
  if (!(possible > 0.0 && possible < kMaxSeconds && used >= 0.0 && used < kMaxSeconds)) return;
  // Over the total time, not the mean of blocks: most blocks of a node that stalls now and then are as fast as ever.
  node->used_seconds = kKept * node->used_seconds + used;
  node->possible_seconds = kKept * node->possible_seconds + possible;
  node->utilisation = std::clamp(node->used_seconds / node->possible_seconds, 0.01, 1.0);
  node->measured_at = now;
}

void NodeSpeeds::compare(const std::string& scene, NodeTable* nodes, TimePoint now) {
  std::vector<double> utilisations;
  for (const auto& [id, node] : *nodes) {
    if (node.has(scene)) utilisations.push_back(node.utilisation);
  }
  const auto middle = utilisations.begin() + static_cast<std::ptrdiff_t>(utilisations.size() / 2);
  std::ranges::nth_element(utilisations, middle);
  const double usual = usual_utilisation_[scene] = utilisations.empty() ? 1.0 : *middle;
  for (auto& [id, node] : *nodes) {
    const bool is_slowed = node.has(scene) && node.utilisation < kSlowed * usual;
    if (!is_slowed || now - node.measured_at < kForgotten) continue;
    node.utilisation *= kRecovery;
    node.possible_seconds *= kRemembered;  // Gives new measurements more weight than old ones.
    node.used_seconds = node.utilisation * node.possible_seconds;
    node.measured_at = now;
  }
}

double NodeSpeeds::of(const Node& node, const std::string& scene) const {
  // Small blocks on many threads and shared hosts make all nodes wait, so only a node that waits far more than the
  // others counts as slowed. Before nodes were compared, none is.
  const auto usual = usual_utilisation_.find(scene);
  const double slowed = usual == usual_utilisation_.end() ? 1.0 : node.utilisation / usual->second;
  const auto known = node.scenes.find(scene);
  return node.threads * (known == node.scenes.end() ? 1.0 : known->second.speed) * (slowed < kSlowed ? slowed : 1.0);
}

double NodeSpeeds::wall_speed_of(const Node& node, const std::string& scene) const {
  const auto usual = usual_utilisation_.find(scene);
  return of(node, scene) * (usual == usual_utilisation_.end() ? 1.0 : usual->second);
}

}  // namespace cyclorama::coordinator
