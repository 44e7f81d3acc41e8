// SPDX-License-Identifier: Apache-2.0
// Light that nodes computed ahead. A scene's pictures use it as soon as one node has it. From then on only nodes that
// have it render the scene; the others are idle then, and have it within minutes.
#include <fmt/format.h>

#include <algorithm>

#include "renderfarm/coordinator/coordinator_state.h"

namespace cyclorama::coordinator {
namespace {

bool uses_light(const governor::ParetoFront& front) {
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (front[i].quality.render.stored_light) return true;
  }
  return false;
}

}  // namespace

bool CoordinatorState::is_lit(const Node& node, const std::string& scene) {
  const auto known = node.scenes.find(scene);
  return node.has(scene) && known->second.front && uses_light(*known->second.front);
}

bool CoordinatorState::needs_light(const std::string& scene) const {
  const auto front = pareto_fronts_.find(scene);
  return front != pareto_fronts_.end() && uses_light(front->second);
}

void CoordinatorState::follow_light(const std::string& scene) {
  const auto lit = std::ranges::find_if(nodes_, [&](const auto& entry) { return is_lit(entry.second, scene); });
  const bool has_light = lit != nodes_.end();
  if (has_light == needs_light(scene) || nodes_with(scene) == 0) return;
  const auto next =
      has_light ? lit : std::ranges::find_if(nodes_, [&](const auto& entry) { return entry.second.has(scene); });
  pareto_fronts_.erase(scene);
  if (const auto& front = next->second.scenes.at(scene).front) pareto_fronts_.emplace(scene, *front);
  for (auto& [id, session] : sessions_) {
    if (session.scene != scene || !session.governed) continue;
    GovernorState& old = *session.governed;
    std::unique_ptr<GovernorState> governed = governed_by(old.governor.budget_ms(), old.reference_samples, scene);
    // A picture at rest continues unchanged.
    governed->asked = std::move(old.asked);
    governed->written_at = old.written_at;
    governed->still_since = old.still_since;
    governed->refinement = old.refinement;
    governed->blocks = std::move(old.blocks);
    governed->failures = old.failures;
    governed->retry_at = old.retry_at;
    governed->ms_per_sample = old.ms_per_sample;
    session.governed = std::move(governed);
  }
  delegate_.notice(has_light
                       ? fmt::format("scene '{}' has its light computed: moving pictures use it from now on", scene)
                       : fmt::format("no node has the computed light of scene '{}': paths are traced", scene),
                   {});
}

}  // namespace cyclorama::coordinator
