// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "common/base/clock.h"
#include "common/wire/farm.pb.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/ids.h"
#include "renderfarm/coordinator/session.h"

namespace cyclorama::coordinator {

/// The sessions that are connected, and the messages to their museums. Pure; thread-bound; the clock and the delegate
/// must outlive it.
class SessionTable {
 public:
  using Map = std::map<SessionId, Session>;

  SessionTable(const Clock& clock, CoordinatorDelegate& delegate) : clock_(clock), delegate_(delegate) {}

  [[nodiscard]] Map::iterator begin() { return sessions_.begin(); }
  [[nodiscard]] Map::iterator end() { return sessions_.end(); }
  [[nodiscard]] Map::const_iterator begin() const { return sessions_.begin(); }
  [[nodiscard]] Map::const_iterator end() const { return sessions_.end(); }
  /// Return null if it is not there.
  [[nodiscard]] Session* find(SessionId id);
  [[nodiscard]] const Session* find(SessionId id) const;
  /// Precondition: it is there.
  [[nodiscard]] Session& at(SessionId id) { return sessions_.at(id); }
  [[nodiscard]] std::size_t size() const { return sessions_.size(); }
  void add(SessionId id, Session session) { sessions_.emplace(id, std::move(session)); }
  void remove(SessionId id) { sessions_.erase(id); }

  /// Returns the frame in flight to which a block belongs; null if it is over.
  [[nodiscard]] FrameInFlight* find_frame(const BlockLocation& place);
  /// Returns the scenes of all open sessions, or of those of one account.
  [[nodiscard]] std::set<std::string> scenes_in_use() const;
  [[nodiscard]] std::set<std::string> scenes_of(AccountId account) const;

  /// Queues a message for the session's museum.
  void send(SessionId id, Session& session, wire::SessionReply reply);
  /// Records that the museum has taken a message.
  void written(Session& session, const wire::SessionReply& reply);

 private:
  const Clock& clock_;
  CoordinatorDelegate& delegate_;
  Map sessions_;
};

}  // namespace cyclorama::coordinator
