// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/light_board.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"

namespace cyclorama::coordinator {

/// Has the light of scenes computed ahead, gives it to all nodes, and decides which version frames use. Nodes compute
/// it together, each its own pieces (LightBoard). The first that has all of it sends the file to the coordinator, which
/// gives it to those that lack it, and when all have it, frames name its version from the next one on. A frame in
/// flight and a picture at rest keep the version that they began with, and only nodes that have a frame's version
/// render it: no picture mixes two. Pure; thread-bound; the table, the speeds, the clock and the delegate must outlive
/// it.
class SceneLights {
 public:
  /// Called when a scene's frames begin to use light, or no longer do: its sessions then need other Pareto fronts.
  using FrontChanged = std::function<void(const std::string& scene)>;

  /// `gathering` is the time that nodes have to connect and report the light that they have, before any is ordered to
  /// compute it.
  SceneLights(Duration gathering, NodeTable& nodes, const NodeSpeeds& speeds, const Clock& clock,
              CoordinatorDelegate& delegate, FrontChanged front_changed)
      : gathering_(gathering),
        nodes_(nodes),
        speeds_(speeds),
        clock_(clock),
        delegate_(delegate),
        front_changed_(std::move(front_changed)) {}

  /// Errors, of this and the next two: kInvalidArgument if the report is broken.
  Status light_reported(NodeId id, Node& node, const wire::SceneLight& report);
  Status pieces_reported(NodeId id, Node& node, const wire::LightPieces& report);
  /// Records that a node has this version of a scene's light.
  static Status add(const wire::LightVersion& light, Node::LoadedScene* scene);
  /// To be called when the coordinator has received this light's file, or that of a piece.
  void stored(const std::string& version);
  /// Takes the next steps for a scene's light: chooses it, has nodes send and fetch it, switches to it, or has it
  /// computed. To be called when nodes have changed, and now and then.
  void follow(const std::string& scene);

  /// Returns the version for new frames; empty if their paths are traced.
  [[nodiscard]] const std::string& in_use(const std::string& scene) const;
  /// Sets the version of the light that a view uses; none if the scene has no light, so that paths are traced.
  void name(const std::string& scene, wire::View* view) const;
  [[nodiscard]] std::string summary(const std::string& scene) const;

 private:
  /// The coordinator's knowledge of the light of a scene.
  struct SceneLightState {
    std::string in_use{};                  ///< Version for new frames; empty: their paths are traced.
    wire::LightVersion target{};           ///< Version that all nodes should have; empty if none is known.
    std::optional<TimePoint> stored_at{};  ///< Time from which the coordinator has the target's file; null: it has not.
    NodeId sending{};                      ///< Node that was ordered to send the target's file.
    TimePoint send_ordered_at{};
    std::map<NodeId, TimePoint> computing{};  ///< Nodes that got the order to take part in computing light, and when.
    LightBoard board{};                       ///< The division of the work among them.
    TimePoint gathering_since{};              ///< Last time when no node could compute any.
  };

  void choose(const std::string& scene, SceneLightState& light);
  void spread(const std::string& scene, SceneLightState& light);
  void switch_to_target(const std::string& scene, SceneLightState& light);
  /// Sets the version for frames that are planned from now on.
  void use(const std::string& scene, SceneLightState& light, const std::string& version);
  /// Has light computed: lets nodes take part, and divides the work among them.
  void order(const std::string& scene, SceneLightState& light);
  void order_computation(NodeId id, const std::string& scene, SceneLightState& light);
  void order_pieces(const std::string& scene, SceneLightState& light);
  /// Ends the division of a computation that is over.
  void clear_board(SceneLightState& light);

  const Duration gathering_;
  NodeTable& nodes_;
  const NodeSpeeds& speeds_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
  const FrontChanged front_changed_;
  std::map<std::string, SceneLightState> lights_;  ///< State of each scene's light.
};

}  // namespace cyclorama::coordinator
