// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/clock.h"
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/block_orders.h"
#include "renderfarm/coordinator/frame_planner.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/scene_lights.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// Refines the pictures of governed sessions at rest: when which picture is next, with which samples, at which nodes.
///
///   moving ──no request──► refining ──reference reached──► at rest: no messages, no blocks
///      ▲                      │                               │
///      └─────── a view ───────┴───────────────────────────────┘
///
/// Pure; thread-bound; what it is given must outlive it.
class RestingPictures {
 public:
  RestingPictures(const NodeTable& nodes, const SceneLights& lights, FramePlanner& planner, BlockOrders& orders,
                  Accounts& accounts, const Clock& clock)
      : nodes_(nodes), lights_(lights), planner_(planner), orders_(orders), accounts_(accounts), clock_(clock) {}

  /// Ends the refinement because a new view has arrived. Precondition: the session is governed.
  void leave(Session& session);
  /// Adds the next picture of a session at rest to its frames, if there is one. Returns its blocks, which are to be
  /// ordered; none if there is no next picture now.
  [[nodiscard]] std::vector<AssignedBlock> begin(SessionId id, Session& session);
  /// To be called when such a frame is over. Returns true if the museum gets it.
  bool finish(Session& session, const FrameInFlight& frame);

 private:
  /// Returns false while the session is not at rest, or its next picture has to wait.
  [[nodiscard]] bool is_due(const Session& session) const;
  /// Sets the view of the next picture.
  void set_view(const Session& session, FrameInFlight* frame) const;

  const NodeTable& nodes_;
  const SceneLights& lights_;
  FramePlanner& planner_;
  BlockOrders& orders_;
  Accounts& accounts_;
  const Clock& clock_;
};

}  // namespace cyclorama::coordinator
