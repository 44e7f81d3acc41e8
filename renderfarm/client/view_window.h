// SPDX-License-Identifier: Apache-2.0
/// Tracks the views sent to the farm, and checks that the replies follow farm.proto's order.
#pragma once

#include <cstdint>
#include <optional>

#include "common/base/frame_window.h"
#include "common/base/picture_cut.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/wire/farm.pb.h"

namespace cyclorama::client {

/// One slot for the waiting view, and the views that were sent and are not answered yet. Pure; thread-bound.
///
///   put() ──► waiting (one, newest wins) ──take_sendable()──► in flight (at most two) ──end() or skipped──► forgotten
///                 ▲                                                │
///                 └──────────────── lose(): the newest ────────────┘
///
/// The frame that ended last may be begun again, refined. Invariants: 1. at most one frame is open (begun and not
/// ended); it is the oldest in flight, or the one that ended last; 2. no two tiles of a frame share a pixel, and those
/// of a complete frame cover it.
class ViewWindow {
 public:
  /// Returns true if this view replaced a waiting one. Precondition: numbers grow.
  bool put(wire::View view);
  /// Returns the waiting view, which is then in flight, if fewer than kFramesInFlight are.
  std::optional<wire::View> take_sendable();

  /// Takes the farm's replies in order. A refused reply changes nothing.
  /// Errors: kBadData if it breaks farm.proto: the scene is not described first and once, another frame is open, the
  /// number was not requested, position, direction or field differ from the request, it has more pixels than requested,
  /// a tile lies outside or overlaps another, or a "complete" frame has holes. kInvalidArgument if the scene has no
  /// walkable area.
  Status take(const wire::SessionReply& reply);

  /// True once the farm has described its scene.
  [[nodiscard]] bool is_opened() const { return opened_; }

  /// Resets the window after the connection was lost. The newest unanswered view waits again, unless a newer one is
  /// waiting already. Returns the number of the open frame, if any.
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
  std::optional<wire::View> answered_;  ///< Requested view of the frame that ended last.
  std::optional<Projection> open_;      ///< Projection of the open frame as begun.
  std::uint64_t open_number_ = 0;
  CoveredCells covered_;  ///< Covered pixels of the open frame.
  std::uint64_t covered_px_ = 0;
  std::uint32_t tiles_ = 0;
};

}  // namespace cyclorama::client
