// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/relay_times.h"

namespace cyclorama {

void RelayTimes::sent(SessionId visit, TimePoint cause) { visits_[visit].causes.push_back(cause); }

void RelayTimes::frame_ended(const FrameReport& report) {
  if (!report.complete || report.refined || report.given_again || report.moved > 0) return;
  const auto visit = visits_.find(report.session);
  if (visit == visits_.end()) return;
  visit->second.frames.push_back(
      {report.view.number(), report.received_at, report.queue_seconds + report.rays_seconds});
}

RelayTimes::Times RelayTimes::taken(SessionId id, const wire::VisitReply& reply, TimePoint at) {
  Times times;
  const auto found = visits_.find(id);
  if (found == visits_.end() || found->second.causes.empty()) return times;
  Visit& visit = found->second;
  const TimePoint cause = visit.causes.front();
  visit.causes.pop_front();
  if (reply.has_tile()) {
    visit.tile_written_at = at;
    times.relay_seconds = to_seconds(at - cause);
  }
  if (!reply.has_end() || visit.frames.empty() || visit.frames.front().view_number != reply.end().view_number()) {
    return times;
  }
  const Frame frame = visit.frames.front();
  visit.frames.pop_front();
  times.overhead_seconds = to_seconds(visit.tile_written_at - frame.received_at) - frame.not_ours_seconds;
  return times;
}

}  // namespace cyclorama
