// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "appliance/tags/tag_search.h"
#include "appliance/tracker/capture.h"
#include "appliance/tracker/tag_tracking.h"
#include "appliance/tracker/tour_link.h"
#include "appliance/tracker/tracker_settings.h"
#include "common/process/stop_signal.h"
#include "common/wire/inspection_service.h"

namespace cyclorama::tracker {

/// The process behind cyclorama-tracker: reads camera pictures and sends poses.
///
///   camera ─▶ capture ─▶ newest frame ─▶ detect ─▶ newest pose ─▶ link ─▶ tour
///
/// Every picture that is searched gives one TrackedPose, whether a pattern was found or not. No external failure ends
/// the tracker: without camera or tour it reports the failure in its state and keeps trying.
class Tracker {
 public:
  /// Borrows `clock` and `inspection`. Errors: kInvalidArgument if a setting can never work: the camera's kind, an
  /// address, or the detector's settings.
  static Result<std::unique_ptr<Tracker>> start(const TrackerSettings& settings, const Clock& clock,
                                                InspectionService* inspection);
  ~Tracker();
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// Updates state and gauges; to be called about twice a second. Thread-bound. Returns false if a thread has been
  /// stuck for longer than any picture takes; then only a restart helps.
  bool supervise();
  /// Returns the sentence that supervise() passed to the inspection.
  [[nodiscard]] const std::string& state() const { return state_; }

 private:
  Tracker(const TrackerSettings& settings, const Clock& clock, InspectionService* inspection,
          std::unique_ptr<camera::Camera> first_camera, tags::TagSearch search, std::unique_ptr<TourLink> link);
  void detect(const std::stop_token& stop);
  void handle(const camera::CameraFrame& frame);
  void handle_body(const camera::CameraFrame& frame);
  void report(const camera::CameraFrame& frame, const TrackingResult& result, const Pinhole& lens,
              std::span<const tags::TagDetection> detections);
  [[nodiscard]] std::vector<tags::TagDetection> straight_tags(const std::vector<tags::TagDetection>& seen,
                                                              const Pinhole& lens);
  [[nodiscard]] wire::TrackedPose pose_of(const camera::CameraFrame& frame) const;
  [[nodiscard]] wire::TrackedPose pose_of(const camera::CameraFrame& frame, const std::optional<TrackedTag>& tag) const;

  const TrackerSettings settings_;
  const Clock& clock_;
  InspectionService& inspection_;
  tags::TagSearch search_;
  TrackingState tracking_;           ///< Used by the detect thread.
  std::optional<BodyTracker> body_;  ///< Used by the detect thread; only if visitors steer by the body.
  std::unique_ptr<TourLink> link_;
  /// Opened at the start, so that mistakes are reported at once; later used by the capture thread.
  std::unique_ptr<camera::Camera> first_camera_;
  Capture capture_;
  std::atomic<TimePoint> detect_alive_at_;
  std::atomic<std::uint64_t> pictures_ = 0;
  std::atomic<int> followed_ = -1;          ///< Wand::id() of the pattern in the newest picture; -1 without one.
  std::atomic<bool> does_lens_fit_ = true;  ///< True if the calibrated lens fits the newest picture's size.
  std::atomic<const char*> body_state_ = "";
  std::uint64_t counted_pictures_ = 0;
  TimePoint counted_at_{};
  std::string state_;
  std::jthread thread_;  ///< The detect thread. Last member, since it uses all the others.
};

}  // namespace cyclorama::tracker
