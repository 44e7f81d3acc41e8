// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "common/base/clock.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// Spreads sessions over the farm. Each session's balancer splits its pictures by the nodes' speeds and order.
/// Placement provides speeds that take the work of all other sessions into account, and an order that begins with the
/// nodes that other sessions use least.
///
/// A session tends to stay on its nodes: nodes that it uses are preferred to slightly freer ones, its order of nodes
/// never changes, and the arrival or loss of another node affects only the sessions that use that node. Pure;
/// thread-bound.
class Placement {
 public:
  /// Expected wall time of a node for one frame of the session.
  struct NodeWork {
    NodeId node{};
    double seconds = 0.0;
  };

  /// Sorts `nodes`, the nodes that can render the session's scene, into the session's order.
  void arrange(SessionId session, std::vector<NodeId>* nodes);
  /// Returns the fraction of the node's speed that other sessions leave to this one, in steps of kStep; at least kStep.
  [[nodiscard]] double free_part(SessionId session, NodeId node) const;
  /// Records how a moving picture was split; replaces the record of the session's previous picture.
  void planned(SessionId session, std::span<const NodeWork> works, TimePoint now);
  /// Forgets the work of sessions that have planned no picture within kExpiry.
  void expire(TimePoint now);
  void forget(SessionId session);
  void forget(NodeId node);

  /// Returns the fraction of the node's time that all sessions take.
  [[nodiscard]] double load(NodeId node) const;

  static constexpr double kStep = 0.125;
  static constexpr Duration kExpiry = std::chrono::seconds(2);

 private:
  struct Place {
    std::map<NodeId, std::size_t> order;  ///< Position of each node that the session has ever been able to use.
    std::size_t next_position = 0;
    std::map<NodeId, double> loads;  ///< Fraction of each node's time that the session takes.
    double seconds_per_frame = 1.0;  ///< Smoothed time between two frames.
    TimePoint planned_at{};
  };
  [[nodiscard]] double load_of_others(const Place& place, NodeId node) const;
  /// Subtracts the work of `place` from the loads of the nodes.
  void clear(Place* place);

  std::map<SessionId, Place> places_;
  std::map<NodeId, double> loads_;
};

}  // namespace cyclorama::coordinator
