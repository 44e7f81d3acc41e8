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
#include "kiosk/tour/caption/caption_writer.h"
#include "kiosk/tour/navigation/visit_walk.h"
#include "kiosk/tour/plan/tour_folder.h"
#include "kiosk/tour/plan/tour_plan.h"
#include "kiosk/tour/session/display_hub.h"
#include "kiosk/tour/session/display_roster.h"
#include "kiosk/tour/session/lamp_fade.h"
#include "kiosk/tour/session/show_meter.h"
#include "kiosk/tour/session/show_schedule.h"
#include "kiosk/tour/session/stop_pictures.h"
#include "kiosk/tour/session/stop_requests.h"
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
/// A cut takes the visitor to another place without a walk. Frames and headings carry the number of cuts before them, so
/// that a display shows no frame from an eye at another place, and fades between the two.
///
/// While the farm is away for longer than a moment, the visit goes on at the stops whose pictures are kept
/// (stop_pictures.h): the visitor looks around there, and gets from stop to stop by cuts.
///
/// Threads: `walk` (every 1/60 s while something moves, and at once for each pose and whenever the farm can take
/// another view), the FarmClient's (forwards tiles), gRPC's (the calls of TourEvents). Thread-safe.
class Tour final : public TourEvents, public StopRequests, private client::FarmListener {
 public:
  /// `inspection` is borrowed. Errors: kInvalidArgument if a coordinator's address is invalid; those of
  /// StopPictures::open().
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

  /// Reads the tour's file, if the settings name a folder and the file has changed. A wrong file is reported in the
  /// state, and the tour of before stays. Call it about every second.
  void read_plan();

  Result<wire::StopList> list_stops() override;
  Result<wire::GoToStopReply> go_to_stop(const wire::GoToStopRequest& request) override;
  Result<wire::AddStopReply> add_stop(const wire::AddStopRequest& request) override;
  Result<wire::UndoStopReply> undo_stop() override;
  Result<wire::SetLampsReply> set_lamps(const wire::SetLampsRequest& request) override;
  Result<wire::FetchPicturesReply> fetch_pictures() override;
  Result<wire::SetCaptionsReply> set_captions(const wire::SetCaptionsRequest& request) override;

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

  // In tour_stops.cpp; all require the lock:

  /// Begins or continues the visit to a scene.
  void open(const wire::SceneDescription& scene, TimePoint now);
  /// Applies the tour's file, or the scene's own stops, to the present scene.
  void apply_plan(TimePoint now);
  /// Reads the files of captions, or takes those of `earlier`, a plan that was read from the same text.
  [[nodiscard]] Result<TourPlan> plan_of(const std::string& text, const TourPlan* earlier) const;
  /// Takes the visitor to a stop. Precondition: can_go_to().
  void go_to(std::size_t stop, TimePoint now);
  void begin_cut();
  /// Cuts where the guide has to, and continues with kept pictures while the farm is away.
  void keep_visiting(TimePoint now);
  void show_kept(std::size_t stop, TimePoint now);
  /// Sets the lamps of the stop that the visitor has reached or is led to, and fades to them.
  void tend_lamps(TimePoint now);
  /// Returns the stop itself, or the next one in steps of `step`, that can be shown now; nothing if none can.
  [[nodiscard]] std::optional<std::size_t> showable(std::size_t stop, int step) const;
  [[nodiscard]] std::optional<std::size_t> nearest_kept() const;
  /// Sets which pictures are to be kept, and whether they may be fetched now.
  void tend_pictures(TimePoint now);
  [[nodiscard]] wire::View view_of(const GuideStop& stop, const Projection& wanted) const;
  void show_tour(TimePoint now);

  // In tour_captions.cpp; all require the lock:

  /// Begins with the languages of the present tour.
  void open_captions();
  /// Writes on the wall what belongs to the stop where the visitor stands, if anything has changed.
  void tend_captions(TimePoint now);
  [[nodiscard]] std::optional<CaptionScript> caption_script() const;
  /// Learns which wall the displays have, and reports on the captions.
  void show_captions();
  void choose_next_language();

  const TourSettings settings_;
  InspectionService& inspection_;
  VisitLog log_;
  DisplayHub hub_;
  ShowSchedule schedule_;
  DisplayRoster roster_;
  std::atomic<std::uint64_t> rounds_{0};

  std::mutex editing_;  ///< Held while the tour's file is changed; locked before mutex_.
  std::mutex mutex_;    ///< Guards the following.
  std::condition_variable woken_;
  bool wake_ = false;
  bool stopping_ = false;
  /// Kept while the farm is away: the walk goes on, and the visitor keeps the position.
  std::optional<Visit> visit_;
  std::optional<std::string> farm_away_;
  TimePoint farm_lost_at_{};
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

  std::uint64_t cuts_;                    ///< Differs from those of an earlier process.
  std::uint64_t first_after_cut_ = 0;     ///< Number of the first view after the last cut.
  std::uint64_t first_live_ = 0;          ///< Number of the first view since the farm's last return from an absence.
  bool is_frame_outdated_ = false;        ///< FarmClient's thread only: the open frame is of a view before first_live_.
  Site scene_site_;                       ///< The scene without a curator's tour.
  std::optional<std::string> plan_text_;  ///< The tour's file; empty: there is none.
  std::optional<std::string> accepted_text_;  ///< The newest text that was a tour of the scene.
  TourPlan accepted_;                         ///< The tour that it was.
  std::optional<TourPlan> plan_;              ///< Empty: the stops are the scene's own.
  std::string plan_problem_;
  std::optional<Projection> wanted_;  ///< Picture that the displays needed last.
  bool are_pictures_told_ = false;    ///< `pictures_` has the present stops and wanted_.
  bool is_fetch_requested_ = false;
  LampFade lamps_;
  std::optional<std::size_t> lamps_of_stop_;                    ///< Stop whose lamps were set last.
  std::optional<std::size_t> kept_shown_;                       ///< Stop whose kept picture the displays show.
  std::unique_ptr<StopPictures> pictures_;                      ///< Null: no folder is set.
  std::vector<std::filesystem::file_time_type> caption_times_;  ///< Times of the files that the newest tour names.
  TourPlan newest_plan_;                        ///< Names these files; empty unless plan_text_ could be read.
  std::vector<std::string> caption_languages_;  ///< Those that are written.
  /// Stop where the visitor has arrived and not left, and when that was.
  std::optional<std::pair<std::size_t, TimePoint>> captions_of_stop_;
  std::optional<CaptionWall> caption_wall_;  ///< Nothing before the first display.
  bool are_captions_told_ = true;            ///< `captions_` has the present script.
  std::optional<TimePoint> back_seen_at_;    ///< Last time at which the wand's back was seen.
  CaptionWriter captions_;

  std::unique_ptr<client::FarmClient> farm_;
  std::thread walker_;
};

}  // namespace cyclorama::tour
