// SPDX-License-Identifier: Apache-2.0
/// Which views are on their way to the farm, and whether what comes back follows farm.proto's order.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/base/picture_cut.h"
#include "common/base/result.h"
#include "common/geometry/projection.h"
#include "common/wire/farm.pb.h"

namespace cyclorama {

/// More would only make pictures older: one is rendered while the other crosses the network.
inline constexpr std::size_t kFramesInFlight = 2;

/// One slot for the view that waits, and the views that were sent and not yet answered. Pure; thread-bound.
///
///   put() ──► waiting (one, newest wins) ──take_sendable()──► in flight (at most two) ──end() or skipped──► forgotten
///                 ▲                                                │
///                 └──────────────── lose(): the newest ────────────┘
///
/// The frame that ended last may be begun again, refined. Invariants: 1. at most one frame is open (begun and not
/// ended); it is the oldest in flight, or that one; 2. no two tiles of a frame share a pixel, and those of a complete
/// frame cover it.
class ViewWindow {
 public:
  /// True if a view that waited was dropped for this one. Precondition: numbers grow.
  bool put(wire::View view);
  /// The waiting view, when fewer than kFramesInFlight are in flight; it is in flight from now on.
  std::optional<wire::View> take_sendable();

  /// What the farm answers, in the order in which it comes. kBadData when it breaks farm.proto: the scene is not
  /// described first and once, another frame is open, a number that was not asked for, another place, direction or
  /// field or more pixels than asked for, a tile outside or over another, a "complete" frame with holes.
  /// kInvalidArgument when the scene cannot be walked in. What is refused changes nothing.
  Status take(const wire::VisitReply& reply);

  /// The farm described its scene.
  [[nodiscard]] bool is_opened() const { return opened_; }

  /// The farm is gone. The newest unanswered view waits again, unless a newer one waits already.
  /// Returns the number of the frame that was open, if one was.
  std::optional<std::uint64_t> lose();

  [[nodiscard]] std::size_t in_flight() const { return in_flight_.size(); }
  [[nodiscard]] bool is_sendable() const { return opened_ && waiting_ && in_flight_.size() < kFramesInFlight; }

 private:
  Status begin(const wire::View& view);
  Status accept(const wire::Tile& tile);
  Status end(const wire::FrameEnd& end);

  bool opened_ = false;
  std::uint64_t newest_ = 0;
  std::optional<wire::View> waiting_;
  std::deque<wire::View> in_flight_;    ///< Growing numbers.
  std::optional<wire::View> answered_;  ///< As asked: the last whose frame ended.
  std::optional<Projection> open_;      ///< As begun.
  std::uint64_t open_number_ = 0;
  CoveredCells covered_;  ///< Of the open frame.
  std::uint64_t covered_px_ = 0;
  std::uint32_t tiles_ = 0;
};

}  // namespace cyclorama
