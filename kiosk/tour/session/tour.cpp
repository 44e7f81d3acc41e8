// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/tour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/text.h"
#include "common/geometry/guard_band.h"
#include "common/geometry/panorama.h"
#include "common/wire/convert.h"
#include "kiosk/tour/navigation/prediction.h"
#include "kiosk/tour/navigation/walk_record.h"
#include "kiosk/tour/session/site.h"

namespace cyclorama::tour {
namespace {

constexpr Duration kRestingTick = std::chrono::milliseconds(100);

/// Returns the duration of a stage that a display reports; zero if it reports none, or an impossible one.
Duration stage_of(const wire::FramePresented& presented, std::string_view name) {
  const auto stage = std::ranges::find(presented.stages(), name, &wire::StageTime::name);
  if (stage == presented.stages().end()) return Duration::zero();
  const double limit_s = to_seconds(ShowMeter::kMaxLatency);
  const double seconds = std::isfinite(stage->seconds()) ? std::clamp(stage->seconds(), 0.0, limit_s) : 0.0;
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

Result<std::unique_ptr<Tour>> Tour::start(TourSettings settings, InspectionService* inspection) {
  client::FarmClientOptions options;
  options.coordinators = settings.coordinators;
  options.scene = settings.scene;
  options.museum = settings.museum;
  options.tls = settings.tls;
  options.frame_budget_ms = settings.picture.frame_budget_ms;
  options.reference_samples = settings.picture.reference_samples;
  auto tour = std::unique_ptr<Tour>(new Tour(std::move(settings), inspection));
  if (!tour->settings_.pictures_folder.empty()) {
    TRY_ASSIGN(tour->pictures_,
               StopPictures::open(tour->settings_.pictures_folder, tour->settings_.keep_bytes, options));
    if (const auto earlier = tour->pictures_->earlier_visit()) {
      const std::lock_guard lock(tour->mutex_);
      tour->wanted_ = *from_wire(earlier->wanted);
      tour->open(earlier->scene, SteadyClock().now());
    }
  }
  tour->read_plan();
  TRY_ASSIGN(tour->farm_, client::FarmClient::start(std::move(options), *tour));
  tour->walker_ = std::thread([raw = tour.get()] { raw->walk(); });
  return tour;
}

Tour::Tour(TourSettings settings, InspectionService* inspection)
    : settings_(std::move(settings)),
      inspection_(*inspection),
      log_(inspection),
      farm_away_("it was not reached yet"),
      farm_lost_at_(SteadyClock().now()),
      record_(settings_.record ? record_head(settings_.navigation) : std::string()),
      pacer_(settings_.picture.frame_budget_ms > 0.0),
      cuts_(static_cast<std::uint64_t>(to_nanoseconds(farm_lost_at_))),
      captions_([this](wire::Caption caption) {
        auto message = std::make_shared<wire::ShowMessage>();
        *message->mutable_caption() = std::move(caption);
        hub_.send_caption(message);
      }) {}

Tour::~Tour() { stop(); }

void Tour::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake();
  if (walker_.joinable()) walker_.join();
  if (farm_ != nullptr) farm_->stop();
  captions_.stop();
  hub_.close(Error(ErrorCode::kUnavailable, "the tour stops"));
}

void Tour::wake() {
  {
    const std::lock_guard lock(mutex_);
    wake_ = true;
  }
  woken_.notify_one();
}

void Tour::walk() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const TimePoint now = SteadyClock().now();
    wake_ = false;
    if (visit_) change(Tick{}, now);
    keep_visiting(now);
    tend_lamps(now);
    tend_captions(now);
    send_heading(now);
    request_frame(now);
    if (now - shown_at_ >= kRestingTick) show_state(now);
    ++rounds_;
    woken_.wait_until(lock, next_round(now), [this] { return wake_ || stopping_; });
  }
}

TimePoint Tour::next_round(TimePoint now) {
  const bool resting = !visit_ || (walk_.navigation.walker.is_at_rest() &&
                                   walk_.navigation.steering_source == SteeringSource::kNobody && !lamps_.is_moving());
  // Ticks of the walk are evenly spaced, whatever else wakes the thread, since displays show one pose per tick.
  if (now >= next_tick_) next_tick_ += kWalkStep;
  if (resting || next_tick_ <= now || next_tick_ > now + kWalkStep) next_tick_ = now + kWalkStep;
  const TimePoint tick = resting ? now + kRestingTick : next_tick_;
  const std::optional<TimePoint> view_due = pacer_.due_at();
  return view_due && *view_due > now ? std::min(tick, *view_due) : tick;
}

void Tour::change(const WalkEvent& event, TimePoint at) {
  walk_ = after(std::move(walk_), event, at, settings_.navigation);
  if (settings_.record) record_ += record_line(event, at, walk_);
}

std::optional<SavedPosition> Tour::position() {
  const std::lock_guard lock(mutex_);
  if (!visit_) return std::nullopt;
  const Walker& walker = walk_.navigation.walker;
  return SavedPosition{visit_->scene.name(), walker.position_m, wrapped_angle(walker.heading_rad)};
}

std::string Tour::take_recording() {
  const std::lock_guard lock(mutex_);
  return std::exchange(record_, {});
}

Eigen::Vector3d Tour::eye_of(const Walker& walker) const {
  constexpr double kAdultM = 1.6;  // Eye height for which a scene is made; the others scale with it.
  const double height_m = plan_ && plan_->eye_height_m ? *plan_->eye_height_m : kAdultM;
  const double y = visit_->scene.start_eye_m().y() + visit_->scene.eye_height_m() * (height_m / kAdultM - 1.0);
  return {walker.position_m.x(), y, walker.position_m.y()};
}

void Tour::send_heading(TimePoint now) {
  if (!visit_) return;
  const Walker& walker = walk_.navigation.walker;
  const std::pair pose(eye_of(walker), walker.heading_rad);
  if (pose_sent_ == pose) return;
  pose_sent_ = pose;
  wire::Heading heading;
  heading.set_heading_rad(pose.second);
  heading.set_shutter_ns(walk_.navigation.steering_source == SteeringSource::kTag ? visit_->shutter_ns : 0);
  to_wire(pose.first, heading.mutable_eye_m());
  heading.set_cuts(cuts_);
  const std::optional<wire::ShowAt> show_at = schedule_.heading_at(now);
  hub_.send_heading(heading, show_at ? &*show_at : nullptr);
}

std::optional<wire::View> Tour::next_view(const Walker& walker) const {
  const std::optional<Projection> wanted = hub_.wanted();
  if (!visit_ || farm_away_ || !wanted) return std::nullopt;
  wire::View view;
  view.set_number(newest_number_ + 1);
  to_wire(eye_of(walker), view.mutable_eye_m());
  view.set_heading_rad(walker.heading_rad);
  const double guard = settings_.picture.guard_rad;
  const double walk_guard = visit_->can_walk && guard > 0.0 ? walk_guard_rad(settings_.navigation.limits) : 0.0;
  to_wire(with_guard_band(*wanted, guard, walk_guard), view.mutable_panorama());
  view.set_depth(visit_->can_walk);
  view.set_samples(static_cast<std::uint32_t>(settings_.picture.samples));
  view.set_jpeg_quality(static_cast<std::uint32_t>(settings_.picture.jpeg_quality));
  view.set_subsample_chroma(settings_.picture.subsample_chroma);
  for (const float level : lamps_.levels()) view.add_lamp_levels(level);
  view.set_shutter_ns(walk_.navigation.steering_source == SteeringSource::kTag ? visit_->shutter_ns : 0);
  return view;
}

void Tour::request_frame(TimePoint now) {
  if (!visit_ || !pacer_.is_due(now) || meter_.are_displays_late(now)) return;
  const Walker shown = predicted(walk_, now + meter_.ahead(schedule_.heading_lead(now)), settings_.navigation);
  predicted_m_ = (shown.position_m - walk_.navigation.walker.position_m).norm();
  const std::optional<wire::View> view = next_view(shown);
  if (!view || !pacer_.wants(*view, now)) return;
  const Status valid = validate(*view);
  view_refused_ = valid ? "" : valid.error().message();
  if (!valid) return;
  newest_number_ = view->number();
  pacer_.asked(*view, now);
  meter_.asked(view->number(), now);
  auto received_at = std::exchange(visit_->pose_received_at, std::nullopt);
  log_.add_view(*view, now, view->shutter_ns() != 0 ? received_at : std::nullopt);
  farm_->request(*view);
}

void Tour::on_pose(std::uint64_t tracker, const wire::TrackedPose& pose) {
  log_.add_pose(pose);
  const TimePoint now = SteadyClock().now();
  {
    const std::lock_guard lock(mutex_);
    if (pose.back()) {
      // One turn of the wand chooses one language, however long its back is seen.
      constexpr Duration kAnotherTurn = std::chrono::milliseconds(700);
      if (!back_seen_at_ || now - *back_seen_at_ > kAnotherTurn) choose_next_language();
      back_seen_at_ = now;
    }
    const auto before = walk_.navigation.tag_seen_at;
    change(pose_seen(tracker, pose), now);
    // The pose is old, has no tag, or belongs to a tracker that does not steer.
    if (!visit_ || walk_.navigation.tag_seen_at == before) return;
    visit_->shutter_ns = pose.shutter_ns();
    visit_->pose_received_at = now;
  }
  wake();
}

void Tour::on_tracker_joined(std::uint64_t tracker) {
  const std::lock_guard lock(mutex_);
  trackers_.insert(tracker);
}

void Tour::on_tracker_left(std::uint64_t tracker) {
  const std::lock_guard lock(mutex_);
  trackers_.erase(tracker);
  change(TrackerLeft{tracker}, SteadyClock().now());
}

void Tour::on_keys(const SteeringCommand& command) {
  const TimePoint now = SteadyClock().now();
  {
    const std::lock_guard lock(mutex_);
    change(KeysPressed{command}, now);
  }
  wake();
}

void Tour::on_display_joined(std::uint64_t display, const wire::DisplayHello& hello) {
  schedule_.joined(display, hello);
  roster_.joined(display, hello);
  {
    const std::lock_guard lock(mutex_);
    meter_.joined(display, refresh_period_of(hello));
    pacer_.set_refresh_period(meter_.refresh_period());
  }
  {
    const std::lock_guard lock(mutex_);
    kept_shown_.reset();
  }
  request_frame_again();
}

void Tour::on_display_left(std::uint64_t display) {
  schedule_.left(display);
  roster_.left(display);
  {
    const std::lock_guard lock(mutex_);
    meter_.left(display);
    pacer_.set_refresh_period(meter_.refresh_period());
  }
  request_frame_again();
}

void Tour::on_clock_question(std::uint64_t display, const wire::ClockRequest& question) {
  schedule_.measured(question, SteadyClock().now());
  roster_.heard(display, question);
}

void Tour::request_frame_again() {
  {
    const std::lock_guard lock(mutex_);
    pacer_.request_again();
  }
  wake();
}

void Tour::on_presented(std::uint64_t display, const wire::FramePresented& presented) {
  const TimePoint now = SteadyClock().now();
  log_.add_presented(presented, now);
  const std::lock_guard lock(mutex_);
  if (meter_.presented(display, presented.view_number(), stage_of(presented, "draw"), now)) pacer_.shown();
}

void Tour::on_dropped(std::uint64_t display, const wire::FrameDropped& dropped) {
  log_.add_not_shown(dropped);
  const std::lock_guard lock(mutex_);
  if (const auto next_after = meter_.not_shown(display, dropped.view_number())) pacer_.not_shown(*next_after);
}

void Tour::on_opened(const wire::SceneDescription& scene) {
  {
    const std::lock_guard lock(mutex_);
    const bool is_held = walk_.site.is_held;
    open(scene, SteadyClock().now());
    farm_away_.reset();
    if (is_held) {
      // The displays fade from the kept picture to the live one. A view from before the loss may be answered first.
      begin_cut();
      first_live_ = first_after_cut_;
    }
    pacer_.request_again();
  }
  inspection_.set_fact("scene", printable(scene.name()));
  inspection_.set_fact("title", printable(scene.title(), 200));
  inspection_.set_fact("credits", printable(scene.credits(), 1000));
  inspection_.set_fact("triangles", std::to_string(scene.triangles_seen()));
  inspection_.set_fact("triangles_stored", std::to_string(scene.triangles_stored()));
  wake();
}

void Tour::on_lost(const Error& reason) {
  const std::lock_guard lock(mutex_);
  if (!farm_away_) farm_lost_at_ = SteadyClock().now();
  farm_away_ = reason.message();
  pacer_.lost();
  meter_.lost();
}

void Tour::broadcast(wire::ShowMessage message) {
  const std::size_t lost = hub_.send(std::make_shared<const wire::ShowMessage>(std::move(message)));
  log_.add_dropped("a display was too slow to take it", lost);
  // A slow display loses frames without delaying the others; if all displays lose a frame, frames come too fast.
  if (lost == 0 || lost < hub_.count()) return;
  const std::lock_guard lock(mutex_);
  pacer_.not_shown(Duration::zero());
}

void Tour::on_begin(const wire::View& view) {
  std::size_t passed_over = 0;
  wire::ShowMessage message;
  {
    const std::lock_guard lock(mutex_);
    is_frame_outdated_ = view.number() < first_live_;
    passed_over = pacer_.began(view.number());
    message.set_cuts(view.number() >= first_after_cut_ ? cuts_ : cuts_ - 1);
  }
  log_.add_dropped("the farm went on to a newer view", passed_over);
  if (is_frame_outdated_) return;
  log_.add_begin(view);
  *message.mutable_begin() = view;
  broadcast(std::move(message));
}

void Tour::on_tile(wire::Tile tile) {
  if (is_frame_outdated_) return;
  log_.add_tile(tile);
  wire::ShowMessage message;
  *message.mutable_tile() = std::move(tile);
  broadcast(std::move(message));
}

void Tour::on_end(const wire::FrameEnd& end) {
  const TimePoint now = SteadyClock().now();
  log_.add_end(end, now);
  {
    const std::lock_guard lock(mutex_);
    pacer_.ended(end.view_number());
    if (end.complete()) meter_.ended(end.view_number(), now);
  }
  wake();
  if (is_frame_outdated_) return;
  wire::ShowMessage message;
  *message.mutable_end() = end;
  const auto show_at = end.complete() ? schedule_.frame_at(now) : std::nullopt;
  if (show_at) *message.mutable_show_at() = *show_at;
  broadcast(std::move(message));
}

}  // namespace cyclorama::tour
