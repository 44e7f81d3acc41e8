// SPDX-License-Identifier: Apache-2.0
/// The visit in numbers: the time of each stage of a frame, from the camera's shutter to the projector's light.
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

namespace cyclorama::tour {

/// Collects the measurements of trackers, farm and displays, adds the tour's own, and publishes them through the
/// InspectionService, which it borrows. Only the tour has the measurements of a frame's whole path.
///
/// stages   capture, detect, pose (tracker) · steer · farm_round_trip · plan, render, encode, farm (FrameEnd) ·
///          decode, wait, draw (display) · shutter_to_photon
/// gauges   frames, frames_per_second, refined_frames, samples_per_pixel, bytes_per_frame, balance_efficiency,
///          picture_scale (width of a moving frame divided by the requested width), wasted_frames_share (share of the
///          last kMaxSent views that no display showed), "dropped: REASON"
///
/// Names and reasons come from the wire: unprintable ones are escaped, and beyond a fixed number they share one entry,
/// so that no peer fills memory. Thread-safe.
class VisitLog {
 public:
  static constexpr std::size_t kMaxSent = 1024;

  explicit VisitLog(InspectionService* inspection);

  void add_pose(const wire::TrackedPose& pose);
  /// `pose_received_at` is the arrival time of the pose that the view follows, given only for the first view that
  /// follows that pose.
  void add_view(const wire::View& view, TimePoint now, std::optional<TimePoint> pose_received_at);
  /// Records the picture that the farm begins to send: its size may be smaller than requested.
  void add_begin(const wire::View& view);
  void add_tile(const wire::Tile& tile);
  void add_end(const wire::FrameEnd& end, TimePoint now);
  /// Counts a frame once, however many displays show it.
  void add_presented(const wire::FramePresented& presented, TimePoint now);
  void add_dropped(const std::string& reason, std::uint64_t frames = 1);
  /// Records that a display did not show this view's frame. A frame counts once, over all displays, and is not counted
  /// again if the farm gave it up before.
  void add_not_shown(const wire::FrameDropped& dropped);
  /// Updates the gauges that depend on the present time.
  void refresh(TimePoint now);

  [[nodiscard]] double frames_per_second(TimePoint now);
  /// Returns a sentence about what the farm refines; nothing while the newest view is rendered for the first time.
  [[nodiscard]] std::optional<std::string> refinement() const;
  /// Returns when the farm last completed a frame.
  [[nodiscard]] std::optional<TimePoint> frame_completed_at() const;

 private:
  struct Sent {
    std::int64_t shutter_ns = 0;
    TimePoint asked_at{};
    std::uint32_t width_px = 0;
    bool ended = false;  ///< True after the first end; later frames refine the view.
    bool presented = false;
    bool dropped = false;
  };
  void add_stages(const google::protobuf::RepeatedPtrField<wire::StageTime>& stages);
  [[nodiscard]] double rate(TimePoint now);
  [[nodiscard]] double wasted_share() const;
  void drop(const std::string& reason, std::uint64_t frames);
  void drop_view(std::uint64_t number, const std::string& reason);

  InspectionService& inspection_;
  mutable std::mutex mutex_;  ///< Guards the following.
  std::map<std::uint64_t, Sent> sent_;
  std::uint64_t newest_presented_ = 0;
  std::set<std::string> stage_names_;
  std::set<std::string> drop_reasons_;
  std::deque<TimePoint> presented_at_;
  std::optional<TimePoint> completed_at_;
  std::optional<std::string> refinement_;
  double frame_bytes_ = 0.0;
  Percentiles bytes_{256};
  Percentiles balance_{256};
};

}  // namespace cyclorama::tour
