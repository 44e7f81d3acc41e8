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

/// How long what goes to museums is on its way: of each tile, from the moment that it came (or that what held it back
/// was gone) until it is written to the museum; of each frame, all but the rays. Used by Coordinator; thread-bound.
///
/// A frame's overhead is what lies between its view's arrival and its last tile's writing, less the time that it waited
/// for older frames of its session, and less the time that the rays take: that of the block that was away longest. Frames
/// whose blocks were moved or given again are left out, since their blocks were away one after the other.
class RelayTimes {
 public:
  /// A message was queued for the museum, because of something that came at `cause`.
  void sent(SessionId session, TimePoint cause);
  /// After its end was sent.
  void frame_ended(const FrameReport& report);
  void session_ended(SessionId session) { sessions_.erase(session); }

  struct Times {
    std::optional<double> relay_seconds{};     ///< Of a tile.
    std::optional<double> overhead_seconds{};  ///< Of a frame, with its end.
  };
  /// The oldest message that was sent and not yet taken is written. Nothing for a session that has ended.
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
