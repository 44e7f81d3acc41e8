// SPDX-License-Identifier: Apache-2.0
/// The visit in numbers: where every frame's time went, from the camera's shutter to the projector's light.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "common/base/clock.h"
#include "common/base/percentiles.h"
#include "common/wire/inspection_service.h"
#include "common/wire/museum.pb.h"

namespace cyclorama {

/// Collects what trackers, farm and displays measured, adds what only the tour sees, and shows it through the
/// InspectionService, which it borrows. This makes the tour the one place that knows a frame's whole way.
///
/// stages   capture, detect, pose (tracker) · steer · farm_round_trip · plan, render, encode, farm (FrameEnd) ·
///          decode, wait, draw (display) · shutter_to_photon
/// gauges   frames, frames_per_second, refined_frames, samples_per_pixel, bytes_per_frame, balance_efficiency,
/// "dropped: REASON"
///
/// Names and reasons come from the wire: odd ones are made printable, and beyond a fixed number they share one entry,
/// so that no peer fills memory. Thread-safe.
class VisitLog {
 public:
  explicit VisitLog(InspectionService* inspection);

  void add_pose(const wire::TrackedPose& pose);
  /// `pose_received_at`: of the pose that the view follows, when it is the first view to follow it.
  void add_view(const wire::View& view, TimePoint now, std::optional<TimePoint> pose_received_at);
  void add_tile(const wire::Tile& tile);
  void add_end(const wire::FrameEnd& end, TimePoint now);
  /// A frame counts once, however many displays show it.
  void add_presented(const wire::FramePresented& presented, TimePoint now);
  void add_dropped(const std::string& reason, std::uint64_t frames = 1);
  /// A display did not show this view's frame. A frame counts once: not for each display, nor again when the farm gave
  /// it up before.
  void add_not_shown(const wire::FrameDropped& dropped);
  /// Brings the gauges that fade with time up to date.
  void refresh(TimePoint now);

  [[nodiscard]] double frames_per_second(TimePoint now);
  /// What the farm refines, in words; nothing while it shows a view for the first time.
  [[nodiscard]] std::optional<std::string> refinement() const;
  /// When the farm last completed a frame.
  [[nodiscard]] std::optional<TimePoint> frame_completed_at() const;

 private:
  struct Sent {
    std::int64_t shutter_ns = 0;
    TimePoint asked_at{};
    bool ended = false;  ///< Once: the frames that follow refine it.
    bool presented = false;
    bool dropped = false;
  };
  void add_stages(const google::protobuf::RepeatedPtrField<wire::StageTime>& stages);
  [[nodiscard]] double rate(TimePoint now);
  void drop(const std::string& reason, std::uint64_t frames);
  void drop_view(std::uint64_t number, const std::string& reason);

  InspectionService& inspection_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::map<std::uint64_t, Sent> sent_;
  std::set<std::string> stage_names_;
  std::set<std::string> drop_reasons_;
  std::deque<TimePoint> presented_at_;
  std::optional<TimePoint> completed_at_;
  std::optional<std::string> refinement_;
  double frame_bytes_ = 0.0;
  Percentiles bytes_{256};
  Percentiles balance_{256};
};

}  // namespace cyclorama
