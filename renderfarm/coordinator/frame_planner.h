// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/clock.h"
#include "common/wire/view.pb.h"
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/placement.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Plans frames: which node renders which part of a picture, and where the frame stands in the order of all museums'
/// frames. Learns from the frames that have ended what parts of pictures cost. Pure; thread-bound; what it is given
/// must outlive it.
class FramePlanner {
 public:
  FramePlanner(const NodeTable& nodes, const NodeSpeeds& speeds, Placement& placement, Accounts& accounts,
               const Clock& clock)
      : nodes_(nodes), speeds_(speeds), placement_(placement), accounts_(accounts), clock_(clock) {}

  /// Returns the number of a new frame.
  std::uint64_t next_frame() { return ++last_frame_; }
  /// Splits the view among the nodes that can render it. `whole_blocks`: each node gets a single block.
  [[nodiscard]] std::vector<AssignedBlock> split(SessionId id, Session& session, const wire::View& view,
                                                 bool whole_blocks);
  /// Determines the frame's position in the order of all museums' frames.
  void take_turn(const Session& session, FrameInFlight* frame);
  /// Records in the placement how much time of the nodes a moving picture will take.
  void place(SessionId id, const Session& session, const std::vector<AssignedBlock>& blocks);
  /// Returns the sum of the threads of all nodes that have a block.
  [[nodiscard]] double threads_of(const std::vector<AssignedBlock>& blocks) const;
  /// Ends the frame's turn, and learns what it cost.
  void finish(Session& session, const FrameInFlight& frame, const FrameReport& report);

 private:
  const NodeTable& nodes_;
  const NodeSpeeds& speeds_;
  Placement& placement_;
  Accounts& accounts_;
  const Clock& clock_;
  std::uint64_t last_frame_ = 0;
};

}  // namespace cyclorama::coordinator
