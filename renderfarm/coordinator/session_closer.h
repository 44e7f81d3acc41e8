// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/base/result.h"
#include "renderfarm/coordinator/accounts.h"
#include "renderfarm/coordinator/block_orders.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/node_table.h"
#include "renderfarm/coordinator/placement.h"
#include "renderfarm/coordinator/session_table.h"

namespace cyclorama::coordinator {

/// Ends everything that the farm does for a session. Pure; thread-bound; what it is given must outlive it.
class SessionCloser {
 public:
  SessionCloser(NodeTable& nodes, SessionTable& sessions, Accounts& accounts, Placement& placement, BlockOrders& orders,
                CoordinatorDelegate& delegate)
      : nodes_(nodes),
        sessions_(sessions),
        accounts_(accounts),
        placement_(placement),
        orders_(orders),
        delegate_(delegate) {}

  /// Forgets the session; its museum is gone. Precondition, here and below: the session is connected.
  void forget(SessionId id);
  /// Forgets the session, and ends its stream with the reason. See CoordinatorDelegate::end_session() for `at_once`.
  void end(SessionId id, const Error& reason, bool at_once);

 private:
  NodeTable& nodes_;
  SessionTable& sessions_;
  Accounts& accounts_;
  Placement& placement_;
  BlockOrders& orders_;
  CoordinatorDelegate& delegate_;
};

}  // namespace cyclorama::coordinator
