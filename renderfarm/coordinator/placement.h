// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "common/base/clock.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// Spreads sessions over the farm. Each session's balancer splits its pictures by the nodes' speeds and order; Placement
/// gives it speeds that take the work of all other sessions into account, and an order in which the nodes that others
/// use least come first.
///
/// A session stays where it is: nodes that it uses are preferred to slightly freer ones, its order of nodes never
/// changes, and what another node's arrival or loss changes concerns only those who use it. Pure; thread-bound.
class Placement {
 public:
  /// Wall time that a node is expected to work for one frame of the session.
  struct NodeWork {
    NodeId node{};
    double seconds = 0.0;
  };

  /// Sorts `nodes`, which can render the session's scene, into the session's order.
  void arrange(SessionId session, std::vector<NodeId>* nodes);
  /// Returns the part of the node's speed that other sessions leave to this one, in steps of kStep and at least that.
  [[nodiscard]] double free_part(SessionId session, NodeId node) const;
  /// A moving picture was split so; replaces the session's earlier one.
  void planned(SessionId session, std::span<const NodeWork> works, TimePoint now);
  /// Forgets the work of sessions that planned no picture lately.
  void expire(TimePoint now);
  void forget(SessionId session);
  void forget(NodeId node);

  /// Part of the node's time that all sessions take.
  [[nodiscard]] double load(NodeId node) const;

  static constexpr double kStep = 0.125;
  static constexpr Duration kExpiry = std::chrono::seconds(2);

 private:
  struct Place {
    std::map<NodeId, std::size_t> order;  ///< Position of each node that could ever render its scene.
    std::size_t next_position = 0;
    std::map<NodeId, double> loads;  ///< Part of each node's time.
    double seconds_per_frame = 1.0;  ///< Smoothed.
    TimePoint planned_at{};
  };
  [[nodiscard]] double load_of_others(const Place& place, NodeId node) const;
  /// Removes the place's work from the nodes.
  void clear(Place* place);

  std::map<SessionId, Place> places_;
  std::map<NodeId, double> loads_;
};

}  // namespace cyclorama::coordinator
