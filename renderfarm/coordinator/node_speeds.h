// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/base/clock.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/node_table.h"

namespace cyclorama::coordinator {

/// Estimates the speeds of nodes: from a small fixed picture that each renders after it has loaded a scene, and from
/// the share of their processors that their blocks receive. A node whose threads wait for a processor far more than
/// those of other nodes counts as slowed until it recovers. Pure; thread-bound.
class NodeSpeeds {
 public:
  /// Returns the speed of one thread of the node that loaded the scene; 1 is a thread of the first node that did.
  [[nodiscard]] double relative(const wire::SceneLoaded& loaded);
  /// Learns the node's utilisation from a block.
  static void learn(Node* node, const wire::BlockEnd& end, TimePoint now);
  /// Updates the usual utilisation of the scene's nodes, their median. To be called now and then.
  void compare(const std::string& scene, NodeTable* nodes, TimePoint now);

  /// Returns the speed of all threads of the node; 1 is one thread of the first node that reported a speed.
  [[nodiscard]] double of(const Node& node, const std::string& scene) const;
  /// Returns the same per wall-clock time: forecasts are thread time, and nodes may share their hosts.
  [[nodiscard]] double wall_speed_of(const Node& node, const std::string& scene) const;

 private:
  std::map<std::string, double> probes_;             ///< Probe time of the first node to report, by scene.
  std::map<std::string, double> usual_utilisation_;  ///< Median of the nodes when they were compared, by scene.
};

}  // namespace cyclorama::coordinator
