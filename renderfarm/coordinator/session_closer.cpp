// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/session_closer.h"

namespace cyclorama::coordinator {

void SessionCloser::forget(SessionId id) {
  const Session& session = sessions_.at(id);
  for (const FrameInFlight& frame : session.frames) {
    if (!frame.failure) orders_.cancel(frame);
    accounts_.end(session.account, frame.turn);
  }
  wire::NodeCommand forget;
  forget.mutable_forget_session()->set_session(static_cast<std::uint64_t>(id));
  for (const auto& [node, known] : nodes_) {
    if (known.has(session.scene)) delegate_.to_node(node, forget);
  }
  accounts_.close(session.account);
  placement_.forget(id);
  sessions_.remove(id);
}

void SessionCloser::end(SessionId id, const Error& reason, bool at_once) {
  forget(id);
  delegate_.end_session(id, reason, at_once);
}

}  // namespace cyclorama::coordinator
