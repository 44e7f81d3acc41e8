// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/wire/museum.pb.h"
#include "kiosk/tour/navigation/walk.h"

namespace cyclorama {

/// What displays, trackers and keys tell the tour; the calls of tour_service.h checked it. Called on gRPC's threads, so
/// implementations are thread-safe and do not block.
class TourEvents {
 public:
  virtual ~TourEvents() = default;
  /// `tracker` names the stream; a tracker that dials again is a new one. `pose` may be without a tag.
  virtual void on_pose(std::uint64_t tracker, const wire::TrackedPose& pose) = 0;
  virtual void on_tracker_joined(std::uint64_t tracker) = 0;
  virtual void on_tracker_left(std::uint64_t tracker) = 0;
  virtual void on_keys(const SteeringWish& wish) = 0;
  /// `display` names the stream; a display that dials again is a new one.
  virtual void on_display_joined(std::uint64_t display, const wire::DisplayHello& hello) = 0;
  virtual void on_display_left(std::uint64_t display) = 0;
  /// The time is answered already; this is about what else it says.
  virtual void on_clock_question(std::uint64_t display, const wire::ClockQuestion& question) = 0;
  virtual void on_presented(const wire::FramePresented& presented) = 0;
  virtual void on_dropped(const wire::FrameDropped& dropped) = 0;

 protected:
  TourEvents() = default;
  TourEvents(const TourEvents&) = default;
  TourEvents& operator=(const TourEvents&) = default;
};

}  // namespace cyclorama
