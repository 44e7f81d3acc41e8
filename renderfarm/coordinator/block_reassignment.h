// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "common/base/clock.h"
#include "common/image/pixel_rect.h"
#include "renderfarm/coordinator/block_orders.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/node_speeds.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/session_table.h"

namespace cyclorama::coordinator {

/// Gives the work of nodes that are slow, silent or gone to other nodes. Pure; thread-bound; what it is given must
/// outlive it.
class BlockReassignment {
 public:
  BlockReassignment(NodeTable& nodes, const NodeSpeeds& speeds, SessionTable& sessions, BlockOrders& orders,
                    const Clock& clock, CoordinatorDelegate& delegate)
      : nodes_(nodes), speeds_(speeds), sessions_(sessions), orders_(orders), clock_(clock), delegate_(delegate) {}

  /// Marks the node as late for the account: it gets no more blocks of the account, and its outstanding tiles are
  /// reassigned. Returns the sessions of which frames have changed.
  std::set<SessionId> retire(NodeId id, AccountId account);
  /// Reassigns blocks that their node will not finish. Returns the sessions of which frames have changed.
  std::set<SessionId> lose(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId not_to);
  /// Orders missing tiles of a frame from other nodes than `not_to`; gives the frame up if none can render them.
  void reassign(SessionId id, Session& session, FrameInFlight& frame, std::vector<PixelRect> tiles, NodeId not_to);
  /// To be called when a node is done with the frame: it may take a block that another node has not begun.
  void move_block_to_idle(SessionId id, Session& session, FrameInFlight& frame, NodeId idle);

 private:
  void log_late(Node& node);

  NodeTable& nodes_;
  const NodeSpeeds& speeds_;
  SessionTable& sessions_;
  BlockOrders& orders_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
};

}  // namespace cyclorama::coordinator
