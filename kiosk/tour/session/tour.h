// SPDX-License-Identifier: Apache-2.0
/// The visit: receives poses and keys, moves the visitor, requests views from the farm, and feeds the displays.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "common/base/clock.h"
#include "common/wire/inspection_service.h"
#include "kiosk/tour/navigation/visit_walk.h"
#include "kiosk/tour/session/display_hub.h"
#include "kiosk/tour/session/display_roster.h"
#include "kiosk/tour/session/show_meter.h"
#include "kiosk/tour/session/show_schedule.h"
#include "kiosk/tour/session/tour_events.h"
#include "kiosk/tour/session/tour_settings.h"
#include "kiosk/tour/session/view_pacer.h"
#include "kiosk/tour/session/visit_log.h"
#include "renderfarm/client/farm_client.h"

namespace cyclorama::tour {

/// Displays, trackers and the farm may come and go at any time, in any order; the state names what is missing.
///
///   trackers ──poses──► ┌─────────────┐ ──views──► FarmClient ──tiles──► DisplayHub ──► displays
///   pages ─────keys───► │ thread walk │ ──headings───────────────────────────┘
///                       └─────────────┘
///
/// A view shows the scene from where the visitor will be when it is displayed (prediction.h); headings, the saved
/// position and the record hold where the visitor is. A wrong prediction is followed by the right view, so that the
/// last view of a visitor who stands still is exact.
///
/// Threads: `walk` (every 1/60 s while something moves, and at once for each pose and whenever the farm can take
/// another view), the FarmClient's (forwards tiles), gRPC's (the calls of TourEvents). Thread-safe.
class Tour final : public TourEvents, private client::FarmListener {
 public:
  /// `inspection` is borrowed. Errors: kInvalidArgument if a coordinator's address is invalid.
  static Result<std::unique_ptr<Tour>> start(TourSettings settings, InspectionService* inspection);
  ~Tour() override;
  Tour(const Tour&) = delete;
  Tour& operator=(const Tour&) = delete;

  [[nodiscard]] DisplayHub* displays() { return &hub_; }
  /// Ends the displays' streams and the visit, and joins the threads. Idempotent.
  void stop();
  /// Counts the rounds of the thread `walk`; the watchdog checks that it grows.
  [[nodiscard]] std::uint64_t rounds() const { return rounds_; }

  /// Returns the visitor's position for the saved file; nothing before the first scene. The heading is within a turn of
  /// 0.
  [[nodiscard]] std::optional<SavedPosition> position();

  /// Returns what was recorded since the last call, in the format of walk_record.h; empty unless the settings enable
  /// recording. Call it about every second, since the record is held in memory until then.
  [[nodiscard]] std::string take_recording();

  void on_pose(std::uint64_t tracker, const wire::TrackedPose& pose) override;
  void on_tracker_joined(std::uint64_t tracker) override;
  void on_tracker_left(std::uint64_t tracker) override;
  void on_keys(const SteeringCommand& command) override;
  void on_display_joined(std::uint64_t display, const wire::DisplayHello& hello) override;
  void on_display_left(std::uint64_t display) override;
  void on_clock_question(std::uint64_t display, const wire::ClockRequest& question) override;
  void on_presented(std::uint64_t display, const wire::FramePresented& presented) override;
  void on_dropped(std::uint64_t display, const wire::FrameDropped& dropped) override;

 private:
  /// The scene, and the newest pose of the steering source.
  struct Visit {
    wire::SceneDescription scene;
    std::string warning;
    bool can_walk = false;
    std::uint64_t first_view = 0;  ///< Number of the first view of this scene.
    bool is_shown = false;         ///< A display has shown a view of this scene.
    std::int64_t shutter_ns = 0;
    std::optional<TimePoint> pose_received_at;  ///< Reset when a view follows the pose.
  };

  Tour(TourSettings settings, InspectionService* inspection);
  void on_opened(const wire::SceneDescription& scene) override;
  void on_lost(const Error& reason) override;
  void on_begin(const wire::View& view) override;
  void on_tile(wire::Tile tile) override;
  void on_end(const wire::FrameEnd& end) override;

  void walk();
  void wake();
  /// Applies an event; every change of the walk goes through here. Requires the lock.
  void change(const WalkEvent& event, TimePoint at);
  void send_heading(TimePoint now);
  void request_frame(TimePoint now);
  /// Returns the time of the next work of thread `walk`, unless it is woken before. Requires the lock.
  [[nodiscard]] TimePoint next_round(TimePoint now);
  /// Returns the position of the visitor's eye in the Scene frame. Requires a visit.
  [[nodiscard]] Eigen::Vector3d eye_of(const Walker& walker) const;
  [[nodiscard]] std::optional<wire::View> next_view(const Walker& walker) const;
  void show_state(TimePoint now);
  [[nodiscard]] std::string state_sentence(TimePoint now, bool* ret_healthy);
  void request_frame_again();
  void broadcast(wire::ShowMessage message);

  const TourSettings settings_;
  InspectionService& inspection_;
  VisitLog log_;
  DisplayHub hub_;
  ShowSchedule schedule_;
  DisplayRoster roster_;
  std::atomic<std::uint64_t> rounds_{0};

  std::mutex mutex_;  ///< Guards the following.
  std::condition_variable woken_;
  bool wake_ = false;
  bool stopping_ = false;
  /// Kept while the farm is away: the walk goes on, and the visitor keeps the position.
  std::optional<Visit> visit_;
  std::optional<std::string> farm_away_;
  std::set<std::uint64_t> trackers_;
  VisitWalk walk_;
  std::string record_;  ///< Lines that were not yet taken.
  ViewPacer pacer_;
  ShowMeter meter_;
  std::uint64_t newest_number_ = 0;
  double predicted_m_ = 0.0;                                     ///< Distance of the newest view's eye.
  std::optional<std::pair<Eigen::Vector3d, double>> pose_sent_;  ///< Eye and heading.
  TimePoint next_tick_{};
  TimePoint shown_at_{};
  std::string view_refused_;

  std::unique_ptr<client::FarmClient> farm_;
  std::thread walker_;
};

}  // namespace cyclorama::tour
