// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/relay_times.h"

namespace cyclorama::coordinator {

void RelayTimes::sent(SessionId session, TimePoint cause) { sessions_[session].causes.push_back(cause); }

void RelayTimes::frame_ended(const FrameReport& report) {
  if (!report.complete || report.refined || report.reassigned || report.moved > 0) return;
  const auto session = sessions_.find(report.session);
  if (session == sessions_.end()) return;
  session->second.frames.push_back(
      {report.view.number(), report.received_at, report.queue_seconds + report.rays_seconds});
}

RelayTimes::Times RelayTimes::taken(SessionId id, const wire::SessionReply& reply, TimePoint at) {
  Times times;
  const auto found = sessions_.find(id);
  if (found == sessions_.end() || found->second.causes.empty()) return times;
  Session& session = found->second;
  const TimePoint cause = session.causes.front();
  session.causes.pop_front();
  if (reply.has_tile()) {
    session.tile_written_at = at;
    times.relay_seconds = to_seconds(at - cause);
  }
  if (!reply.has_end() || session.frames.empty() || session.frames.front().view_number != reply.end().view_number()) {
    return times;
  }
  const Frame frame = session.frames.front();
  session.frames.pop_front();
  times.overhead_seconds = to_seconds(session.tile_written_at - frame.received_at) - frame.not_ours_seconds;
  return times;
}

}  // namespace cyclorama::coordinator
