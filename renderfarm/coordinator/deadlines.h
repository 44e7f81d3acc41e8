// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/clock.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Computes when a frame is late, and which nodes delay it. All deadlines are multiples of a session's base time: its budget, or
/// its recent frame time if that is longer. Decides nothing and changes nothing. Pure; thread-bound; the table, the
/// speeds and the clock must outlive it.
class Deadlines {
 public:
  Deadlines(const NodeTable& nodes, const NodeSpeeds& speeds, const Clock& clock)
      : nodes_(nodes), speeds_(speeds), clock_(clock) {}

  /// Returns the next deadline of the session's foremost frame.
  [[nodiscard]] TimePoint next_due(const Session& session) const;
  /// Returns true if the frame would be given up for a successor.
  [[nodiscard]] bool is_late(const Session& session, const FrameInFlight& frame) const;
  /// Returns the nodes that delay the frame while others are done with it.
  [[nodiscard]] std::vector<NodeId> silent_nodes(const Session& session, const FrameInFlight& frame) const;

 private:
  [[nodiscard]] TimePoint due_at(const Session& session, const FrameInFlight& frame,
                                 const FrameAssembly::Block& block) const;
  [[nodiscard]] bool has_idle_node(const Session& session, const FrameInFlight& frame) const;

  const NodeTable& nodes_;
  const NodeSpeeds& speeds_;
  const Clock& clock_;
};

}  // namespace cyclorama::coordinator
