// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/scene_catalogue.h"
#include "renderfarm/coordinator/scene_lights.h"
#include "renderfarm/coordinator/session_table.h"

namespace cyclorama::coordinator {

/// Has nodes load scenes: those of open sessions first, then the others in the catalogue's order. Nodes that drop a
/// scene, or fail to load it, get the order again when a session requests it. Pure; thread-bound; what it is given must
/// outlive it.
class SceneOrders {
 public:
  SceneOrders(SceneCatalogue& catalogue, NodeTable& nodes, NodeSpeeds& speeds, SceneLights& lights,
              const SessionTable& sessions, const Clock& clock, CoordinatorDelegate& delegate)
      : catalogue_(catalogue),
        nodes_(nodes),
        speeds_(speeds),
        lights_(lights),
        sessions_(sessions),
        clock_(clock),
        delegate_(delegate) {}

  /// Orders all scenes that are ready from a node that has come.
  void order_all(NodeId id, Node& node);
  /// Orders a scene for a session if no node has it: nodes that dropped it, or failed to load it a while ago, try
  /// again.
  void order_anew(const std::string& scene);
  /// To be called when the file list of a distributed scene has been read; nodes may then load the scene.
  void read(const std::string& scene, const std::string& digest);
  /// Errors, of this and the next: kInvalidArgument if the message is broken.
  Status loaded(Node& node, const wire::SceneLoaded& loaded);
  Status dropped(Node& node, const wire::SceneDropped& dropped);

  /// Returns why no node has the scene.
  [[nodiscard]] Error unavailable_reason(const std::string& scene) const;

 private:
  void order(NodeId id, Node& node, const FarmScene& scene, const std::set<std::string>& keep);

  SceneCatalogue& catalogue_;
  NodeTable& nodes_;
  NodeSpeeds& speeds_;
  SceneLights& lights_;
  const SessionTable& sessions_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
};

}  // namespace cyclorama::coordinator
