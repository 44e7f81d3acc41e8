// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/wire/museum.pb.h"
#include "kiosk/tour/navigation/walk.h"

namespace cyclorama::tour {

/// Events from displays, trackers and keys, after the checks of tour_service.h. Called on gRPC's threads, so
/// implementations are thread-safe and do not block.
class TourEvents {
 public:
  virtual ~TourEvents() = default;
  /// `tracker` identifies the stream; a tracker that connects again is a new one. `pose` may have no tag.
  virtual void on_pose(std::uint64_t tracker, const wire::TrackedPose& pose) = 0;
  virtual void on_tracker_joined(std::uint64_t tracker) = 0;
  virtual void on_tracker_left(std::uint64_t tracker) = 0;
  virtual void on_keys(const SteeringCommand& command) = 0;
  /// `display` identifies the stream; a display that connects again is a new one.
  virtual void on_display_joined(std::uint64_t display, const wire::DisplayHello& hello) = 0;
  virtual void on_display_left(std::uint64_t display) = 0;
  /// Handles the measurements in a clock request, whose time has already been answered.
  virtual void on_clock_question(std::uint64_t display, const wire::ClockRequest& question) = 0;
  virtual void on_presented(std::uint64_t display, const wire::FramePresented& presented) = 0;
  virtual void on_dropped(std::uint64_t display, const wire::FrameDropped& dropped) = 0;

 protected:
  TourEvents() = default;
  TourEvents(const TourEvents&) = default;
  TourEvents& operator=(const TourEvents&) = default;
};

}  // namespace cyclorama::tour
