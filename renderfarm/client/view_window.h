// SPDX-License-Identifier: Apache-2.0
/// Tracks the views sent to the farm, and checks that replies come in the order that farm.proto requires.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/frame_window.h"
#include "common/base/picture_cut.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/wire/farm.pb.h"

namespace cyclorama::client {

/// One slot for a waiting view, and the views that were sent and are not answered yet. Pure; thread-bound.
///
///   put() ──► waiting (one, newest wins) ──take_sendable()──► in flight (at most two) ──end() or skipped──► forgotten
///                 ▲                                                │
///                 └──────────────── lose(): the newest ────────────┘
///
/// The frame that ended last may begin again as a refinement. Invariants: 1. at most one frame is open (begun and not
/// ended); it is the oldest in flight, or the frame that ended last; 2. no two tiles of a frame share a pixel, and the
/// tiles of a complete frame cover it.
class ViewWindow {
 public:
  /// Puts a view into the slot. Returns true if it replaced a waiting one. Precondition: numbers increase.
  bool put(wire::View view);
  /// Moves the waiting view into flight and returns it, if fewer than kFramesInFlight are in flight.
  std::optional<wire::View> take_sendable();

  /// Accepts a reply of the farm; replies must be passed in order. A refused reply changes nothing. Errors: kBadData if
  /// the reply violates farm.proto: the scene is not described exactly once, at the beginning; another frame is open;
  /// the number was not requested; position, direction or field differ from the request; the picture has more pixels
  /// than requested; a tile is outside the picture or overlaps another; or a "complete" frame has gaps.
  /// kInvalidArgument if the scene has no walkable area.
  Status take(const wire::SessionReply& reply);

  /// Returns true once the farm has described its scene.
  [[nodiscard]] bool is_opened() const { return opened_; }

  /// Resets the window after a loss of the connection. The newest unanswered view waits again, unless a newer one is
  /// already waiting. Returns the number of the open frame, if any.
  std::optional<std::uint64_t> lose();

  [[nodiscard]] std::size_t in_flight() const { return views_.in_flight(); }
  [[nodiscard]] bool is_sendable() const { return opened_ && views_.is_sendable(); }

 private:
  Status begin(const wire::View& view);
  Status accept(const wire::Tile& tile);
  Status end(const wire::FrameEnd& end);

  bool opened_ = false;
  std::uint64_t newest_ = 0;
  FrameWindow<wire::View> views_;
  std::optional<wire::View> answered_;  ///< View that was requested for the frame that ended last.
  std::optional<Projection> open_;      ///< Projection with which the open frame began.
  std::uint64_t open_number_ = 0;
  CoveredCells covered_;  ///< Pixels of the open frame that its tiles cover.
  std::uint64_t covered_px_ = 0;
  std::uint32_t tiles_ = 0;
};

}  // namespace cyclorama::client
