// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/clock.h"
#include "common/image/pixel_rect.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/session_table.h"

namespace cyclorama::coordinator {

/// Orders blocks from nodes, cancels them, and charges museums' accounts for what nodes report of them. Pure;
/// thread-bound; what it is given must outlive it.
class BlockOrders {
 public:
  /// Processor time that the farm spends on a block beyond its rays: one tile and its acknowledgement through gRPC with
  /// TLS, in seconds. Each block is charged for it, so that a museum cannot get more than its share by requesting many
  /// tiny pictures.
  static constexpr double kOverheadSeconds = 0.0003;

  BlockOrders(NodeTable& nodes, SessionTable& sessions, Accounts& accounts, const Clock& clock,
              CoordinatorDelegate& delegate)
      : nodes_(nodes), sessions_(sessions), accounts_(accounts), clock_(clock), delegate_(delegate) {}

  /// Returns a number for a new block; numbers increase by 1.
  std::uint64_t next_number() { return ++last_; }
  [[nodiscard]] std::uint64_t last_number() const { return last_; }
  /// Orders a block of the frame from the node.
  void order(SessionId id, Session& session, const FrameInFlight& frame, std::uint64_t block, NodeId node,
             const PixelRect& rect);
  void cancel(NodeId node, std::uint64_t block);
  /// Cancels the frame's blocks that their nodes have not ended.
  void cancel(const FrameInFlight& frame);
  /// Gives up the frame: drops the tiles that it holds, and cancels its blocks.
  void give_up(FrameInFlight& frame, const std::string& reason, Session& session);

  /// Records that the node has ended a block, and charges it. Returns to what it belonged; nothing if it was not the
  /// node's.
  std::optional<BlockLocation> end(Node& node, const wire::BlockEnd& end);
  /// Charges what the node has spent on a block so far. Returns false if the block is not the node's.
  bool progress(Node& node, const wire::BlockProgress& progress);

 private:
  /// Charges the block's account for the time that the node has spent on the block so far.
  void charge(BlockLocation* place, double cpu_seconds);
  /// Adds what the other accounts with blocks at the node have received elsewhere, if that is much.
  void state_service(Node& node, AccountId except, wire::RenderBlock* order) const;

  NodeTable& nodes_;
  SessionTable& sessions_;
  Accounts& accounts_;
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
  std::uint64_t last_ = 0;
};

}  // namespace cyclorama::coordinator
