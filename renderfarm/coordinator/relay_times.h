// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "common/base/clock.h"
#include "common/wire/farm.pb.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/coordinator/ids.h"

namespace cyclorama::coordinator {

/// Measures the delay that the coordinator adds to messages for museums. For each tile, it is the time from the tile's
/// arrival, or from when it was no longer held back, until it is written to the museum; for each frame, the frame's
/// overhead. Used by Coordinator; thread-bound.
///
/// A frame's overhead is the time from the arrival of its view to the writing of its last tile, minus the time spent
/// waiting for older frames of its session, and minus the longest time that one of its blocks was at a node. Frames
/// with moved or reassigned blocks are omitted, since these blocks were at several nodes in succession.
class RelayTimes {
 public:
  /// Records that a message was queued for the museum because of an event at `cause`.
  void sent(SessionId session, TimePoint cause);
  /// To be called after the frame's end was sent.
  void frame_ended(const FrameReport& report);
  void session_ended(SessionId session) { sessions_.erase(session); }

  struct Times {
    std::optional<double> relay_seconds{};     ///< Set if the message is a tile.
    std::optional<double> overhead_seconds{};  ///< Set if the message is a frame's end.
  };
  /// Records that the oldest message passed to sent() and not yet taken has been written. Returns nothing for a session
  /// that has ended.
  Times taken(SessionId session, const wire::SessionReply& reply, TimePoint at);

 private:
  struct Frame {
    std::uint64_t view_number = 0;
    TimePoint received_at{};
    double not_ours_seconds = 0.0;
  };
  struct Session {
    std::deque<TimePoint> causes{};
    std::deque<Frame> frames{};
    TimePoint tile_written_at{};
  };
  std::map<SessionId, Session> sessions_;
};

}  // namespace cyclorama::coordinator
