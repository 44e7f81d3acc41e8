// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "common/base/clock.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Computes when a frame is late, and which nodes delay it. All deadlines are multiples of a session's base time: its
/// budget, or its recent frame time if that is longer. Decides nothing and changes nothing. Pure; thread-bound; the
/// table, the speeds and the clock must outlive it.
class Deadlines {
 public:
  Deadlines(const NodeTable& nodes, const NodeSpeeds& speeds, const Clock& clock)
      : nodes_(nodes), speeds_(speeds), clock_(clock) {}

  /// Returns the deadlines of the session's oldest frame; max() if there is none.
  [[nodiscard]] DueTimes due(const Session& session) const;
  /// Returns true if the frame would be given up for a successor.
  [[nodiscard]] bool is_late(const Session& session, const FrameInFlight& frame) const;
  /// Returns the nodes that delay the frame while others are done with it.
  [[nodiscard]] std::vector<NodeId> silent_nodes(const Session& session, const FrameInFlight& frame) const;

 private:
  /// Calls `visit` with each node that owes blocks of the frame, and the earliest time at which one is due.
  void for_each_due(const Session& session, const FrameInFlight& frame,
                    const std::function<void(NodeId, const Node&, TimePoint)>& visit) const;
  [[nodiscard]] bool has_idle_node(const Session& session, const FrameInFlight& frame) const;

  const NodeTable& nodes_;
  const NodeSpeeds& speeds_;
  const Clock& clock_;
};

}  // namespace cyclorama::coordinator
