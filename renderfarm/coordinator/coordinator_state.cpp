// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_state.h"

#include <fmt/format.h>

#include <algorithm>

namespace cyclorama::coordinator {

CoordinatorState::CoordinatorState(std::vector<FarmScene> scenes, balance::BalanceStrategy strategy,
                                   CoordinatorLimits limits, const Clock& clock, CoordinatorDelegate& delegate)
    : scenes_(std::move(scenes)), strategy_(strategy), limits_(limits), clock_(clock), delegate_(delegate) {
  CHECK(!scenes_.empty());
}

void CoordinatorState::tick() {
  for (const FarmScene& scene : scenes_) speeds_.compare(scene.name, &nodes_, clock_.now());
  accounts_.set_threads(nodes_.capacity());
  placement_.expire(clock_.now());
  tick_nodes();
  for (const FarmScene& scene : scenes_) follow_light(scene.name);
  tick_sessions();
}

wire::ListScenesReply CoordinatorState::scenes(const trust::Grant& grant) const {
  wire::ListScenesReply reply;
  for (const FarmScene& scene : scenes_) {
    if (!grant.allows(scene.name)) continue;
    wire::SceneSummary* const summary = reply.add_scenes();
    summary->set_name(scene.name);
    const wire::SceneDescription* const known = description(scene.name);
    summary->set_title(known != nullptr && !known->title().empty() ? known->title() : scene.name);
  }
  return reply;
}

const wire::SceneDescription* CoordinatorState::description(const std::string& scene) const {
  const auto known = descriptions_.find(scene);
  return known == descriptions_.end() ? nullptr : &known->second;
}

std::size_t CoordinatorState::nodes_with(const std::string& scene) const { return nodes_.count_with(scene); }

std::string CoordinatorState::summary() const {
  if (nodes_.empty()) return "no node is connected; start cyclorama-node on the render hosts";
  for (const FarmScene& scene : scenes_) {
    if (nodes_with(scene.name) == 0) return unavailable_reason(scene.name).message();
  }
  std::string sentence = fmt::format("{} sessions on {} nodes", sessions_.size(), nodes_.size());
  if (sessions_.size() == 1) {
    if (const std::string quality = quality_summary(sessions_.begin()->second); !quality.empty()) {
      sentence += "; " + quality;
    }
  }
  return sentence;
}

}  // namespace cyclorama::coordinator
