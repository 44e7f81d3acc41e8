// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_state.h"

#include <fmt/format.h>

#include <utility>

#include "renderfarm/coordinator/session_governor.h"

namespace cyclorama::coordinator {

CoordinatorState::CoordinatorState(std::vector<FarmScene> scenes, balance::BalanceStrategy strategy,
                                   CoordinatorLimits limits, const Clock& clock, CoordinatorDelegate& delegate)
    : strategy_(strategy), limits_(limits), clock_(clock), delegate_(delegate), catalogue_(std::move(scenes)) {}

void CoordinatorState::tick() {
  for (const FarmScene& scene : catalogue_.all()) speeds_.compare(scene.name, &nodes_, clock_.now());
  accounts_.set_threads(nodes_.capacity());
  placement_.expire(clock_.now());
  tick_nodes();
  for (const FarmScene& scene : catalogue_.all()) lights_.follow(scene.name);
  tick_sessions();
}

std::string CoordinatorState::summary() const {
  if (nodes_.empty()) return "no node is connected; start cyclorama-node on the render hosts";
  for (const FarmScene& scene : catalogue_.all()) {
    if (nodes_with(scene.name) == 0) return scene_orders_.unavailable_reason(scene.name).message();
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
