// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "common/base/clock.h"
#include "common/base/result.h"
#include "common/wire/farm.pb.h"
#include "common/wire/nodes.pb.h"
#include "renderfarm/coordinator/block_orders.h"
#include "renderfarm/coordinator/block_reassignment.h"
#include "renderfarm/coordinator/deadlines.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/frame_planner.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/resting_pictures.h"
#include "renderfarm/coordinator/scene_lights.h"
#include "renderfarm/coordinator/scene_orders.h"
#include "renderfarm/coordinator/session_closer.h"
#include "renderfarm/coordinator/session_table.h"

namespace cyclorama::coordinator {

/// Takes each frame from a waiting view to the frame's end.
///
/// A view waits in one slot, in which a newer view replaces it, until fewer than two frames of its session are
/// unfinished or unwritten. It is then split among the nodes that have the scene, and all blocks are sent at once, so
/// that a node can start its next block as soon as it has sent the previous one. If two frames are in flight, the tiles
/// of the older one are relayed to the museum as they arrive, and the tiles of the newer one are held. A refined
/// picture is sent only once it is complete, so the museum never sees a part of one that the next view cancels.
///
/// The deadlines of a frame are counted from the moment when it becomes the oldest frame of its session (Deadlines). An
/// idle node takes blocks that others have not begun. A node that is silent while others are done gets no more blocks
/// of the account; its outstanding tiles are cut and reassigned, so that all nodes help. A late frame with a successor
/// is given up: the last complete picture stands in for it, and the frame's end reports this. The outstanding tiles of
/// a node that disconnects or fails are reassigned at once. The first delivery of a tile counts; later deliveries are
/// dropped.
///
/// Invariants: 1. the museum gets the begin, tiles and end of one frame before those of the next; 2. no tile is sent
/// twice; 3. all tiles of a frame that ends `complete` were sent; 4. each view is answered by a frame or replaced by a
/// newer view; 5. memory per session is bounded. Pure; thread-bound; the parts must outlive it.
class FrameScheduler {
 public:
  struct Parts {
    const Clock& clock;
    CoordinatorDelegate& delegate;
    NodeTable& nodes;
    SessionTable& sessions;
    const Deadlines& deadlines;
    const SceneLights& lights;
    const SceneOrders& scenes;
    FramePlanner& planner;
    BlockOrders& orders;
    BlockReassignment& reassignment;
    RestingPictures& resting;
    SessionCloser& closer;
  };
  /// `max_session_bytes` limits the tiles that wait to be written to one museum; beyond that, its newest frame is given
  /// up.
  FrameScheduler(std::size_t max_session_bytes, const Parts& parts)
      : max_session_bytes_(max_session_bytes), parts_(parts) {}

  /// Puts a view, which must be allowed, into the session's slot.
  void request(Session& session, const wire::View& view, TimePoint received_at);
  /// Sends the tiles and messages that may be sent, ends frames that are over, and plans waiting views. Called after
  /// every event of a session; may end the session.
  void advance(SessionId id);
  /// Checks the deadlines of the session's oldest frame. May end the session.
  void watch(SessionId id);
  /// Plans the next picture of a session at rest, if there is one.
  void refine(SessionId id, Session& session);
  /// To be called when a message has been written to the museum's stream.
  void written(SessionId id, const wire::SessionReply& reply);

  /// Errors, of this and the next two: kInvalidArgument if the message is broken.
  Status tile_received(Node& node, wire::BlockTile& message);
  Status block_ended(NodeId id, Node& node, const wire::BlockEnd& end);
  Status block_progressed(Node& node, const wire::BlockProgress& progress);
  /// Reassigns the blocks of a node that has gone.
  void lose(const std::map<std::uint64_t, BlockLocation>& blocks, NodeId gone);
  /// To be called when the command to render a block has been written to the node's stream.
  void order_written(NodeId node, std::uint64_t block, TimePoint at);

  /// Returns the next deadline of any session's oldest frame.
  [[nodiscard]] TimePoint next_deadline() const;

 private:
  void plan(SessionId id, Session& session);
  void order(SessionId id, Session& session, FrameInFlight& frame, const std::vector<AssignedBlock>& blocks);
  void begin(SessionId id, Session& session, FrameInFlight& frame);
  void relay(SessionId id, Session& session, wire::Tile tile);
  void finish(SessionId id, Session& session, FrameInFlight& frame);
  void end(SessionId id, Session& session, const FrameInFlight& frame, const FrameReport& report);
  void meet_deadlines(SessionId id);
  void advance_all(const std::set<SessionId>& sessions);

  const std::size_t max_session_bytes_;
  const Parts parts_;
};

}  // namespace cyclorama::coordinator
