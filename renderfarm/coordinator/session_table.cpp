// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/session_table.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"
#include "common/wire/payload.h"

namespace cyclorama::coordinator {

Session* SessionTable::find(SessionId id) {
  const auto found = sessions_.find(id);
  return found == sessions_.end() ? nullptr : &found->second;
}

const Session* SessionTable::find(SessionId id) const {
  const auto found = sessions_.find(id);
  return found == sessions_.end() ? nullptr : &found->second;
}

FrameInFlight* SessionTable::find_frame(const BlockLocation& place) {
  Session* const session = find(place.session);
  if (session == nullptr) return nullptr;
  const auto frame = std::ranges::find(session->frames, place.frame, &FrameInFlight::id);
  return frame == session->frames.end() ? nullptr : &*frame;
}

std::set<std::string> SessionTable::scenes_in_use() const {
  std::set<std::string> names;
  for (const auto& [id, session] : sessions_) {
    if (!session.scene.empty()) names.insert(session.scene);
  }
  return names;
}

std::set<std::string> SessionTable::scenes_of(AccountId account) const {
  std::set<std::string> names;
  for (const auto& [id, session] : sessions_) {
    if (session.account == account && !session.scene.empty()) names.insert(session.scene);
  }
  return names;
}

void SessionTable::send(SessionId id, Session& session, wire::SessionReply reply) {
  if (session.messages_waiting++ == 0) session.taken_at = clock_.now();
  delegate_.to_museum(id, std::move(reply));
}

void SessionTable::written(Session& session, const wire::SessionReply& reply) {
  CHECK(session.messages_waiting > 0);
  --session.messages_waiting;
  session.taken_at = clock_.now();
  if (reply.has_tile()) session.bytes_waiting -= payload_bytes(reply.tile());
}

}  // namespace cyclorama::coordinator
