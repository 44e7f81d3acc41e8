// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/governed.h"
#include "renderfarm/governor/front.h"
#include "renderfarm/trust/grants.h"

namespace cyclorama::coordinator {

struct FarmScene {
  std::string name;
  std::string path;
  /// True if the path is on the coordinator's disk; nodes then fetch the files that they lack.
  bool on_coordinator = false;
  std::string digest{};  ///< If on_coordinator, the digest of its file list; empty until the files have been read.

  /// Returns true once the scene can be announced to nodes.
  [[nodiscard]] bool is_ready() const { return !on_coordinator || !digest.empty(); }
};

/// The farm's scenes, and what nodes state of them: descriptions, Pareto fronts and bounces. Pure; thread-bound.
class SceneCatalogue {
 public:
  /// The first scene is the default. Precondition: there is at least one scene, and the names are unique.
  explicit SceneCatalogue(std::vector<FarmScene> scenes);

  [[nodiscard]] const std::vector<FarmScene>& all() const { return scenes_; }
  /// Precondition: the farm has the scene.
  [[nodiscard]] const FarmScene& at(const std::string& name) const;
  /// Returns the scene that a museum may open; an empty name selects the first that its grant allows. Errors:
  /// kNotFound.
  [[nodiscard]] Result<FarmScene> find(const std::string& wanted, const trust::Grant& grant,
                                       const std::string& museum) const;
  [[nodiscard]] wire::ListScenesReply list(const trust::Grant& grant) const;
  /// Records the digest of a scene's file list. Precondition: it is a scene on the coordinator's disk without one.
  const FarmScene& set_digest(const std::string& scene, const std::string& digest);

  /// Returns null if no node has described the scene.
  [[nodiscard]] const wire::SceneDescription* description(const std::string& scene) const;
  /// Replaces what is known of a scene by what a node states of it. Errors: kInvalidArgument if that is not valid.
  Status learn(const wire::SceneLoaded& loaded);
  /// Returns the governor of a session in the scene. `has_light`: the scene's stored light is in use.
  [[nodiscard]] std::unique_ptr<GovernorState> governed(double budget_ms, int reference_samples,
                                                        const std::string& scene, bool has_light) const;

 private:
  std::vector<FarmScene> scenes_;
  std::map<std::string, wire::SceneDescription> descriptions_;  ///< Scenes that any node has loaded so far.
  std::map<std::string, governor::ParetoFront> pareto_fronts_;  ///< Pareto fronts of the measured scenes, by scene.
  std::map<std::string, int> bounces_;                          ///< Bounces that nodes stated, by scene.
};

}  // namespace cyclorama::coordinator
