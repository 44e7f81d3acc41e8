// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/tracker.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "appliance/calibration/camera_file.h"
#include "appliance/tags/straight_corners.h"
#include "appliance/tracker/overlay.h"
#include "common/base/text.h"
#include "common/wand/folded_card.h"
#include "common/wire/convert.h"
#include "drivers/devices/make_camera.h"

namespace cyclorama::tracker {
namespace {

constexpr Duration kLookAround = std::chrono::milliseconds(200);
/// Time without activity after which a thread counts as stuck. A search of the largest supported picture takes about
/// four seconds on a slow core.
constexpr Duration kStuckAfter = std::chrono::seconds(15);
constexpr const char* kPicture = "camera";

void add_stage(const char* name, Duration duration, InspectionService* inspection, wire::TrackedPose* ret_pose) {
  inspection->add_stage_time(name, duration);
  wire::StageTime* const stage = ret_pose->add_stages();
  stage->set_name(name);
  stage->set_seconds(to_seconds(duration));
}

/// Adds the upper triangle of the covariance, 21 numbers, row by row.
void add_covariance(const Matrix6d& covariance, wire::TrackedPose* ret_pose) {
  for (Eigen::Index row = 0; row < 6; ++row) {
    for (Eigen::Index column = row; column < 6; ++column) ret_pose->add_covariance(covariance(row, column));
  }
}

void set_pose(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag, wire::TrackedPose* ret_pose) {
  to_wire(T_camera_tag.translation(), ret_pose->mutable_position_m());
  const Eigen::Quaterniond& rotation = T_camera_tag.rotation();
  ret_pose->set_rotation_w(rotation.w());
  ret_pose->set_rotation_x(rotation.x());
  ret_pose->set_rotation_y(rotation.y());
  ret_pose->set_rotation_z(rotation.z());
}

/// Returns the covariance of a body's pose. It is large for everything that one camera cannot measure of a body: its
/// turns, except the lean, and its height.
Matrix6d covariance_of(const BodyPose& pose) {
  constexpr double kAnyTurn = 1.0, kAnyHeight = 0.3;
  Eigen::Matrix<double, 6, 1> deviations;
  deviations << kAnyTurn, kAnyTurn, pose.lean_deviation_rad, pose.x_deviation_m, kAnyHeight, pose.depth_deviation_m;
  return deviations.cwiseAbs2().asDiagonal();
}

std::string describe(const PatternSettings& patterns) {
  if (patterns.flat_tag_size_m) return fmt::format("flat tags of {:.0f} mm", 1e3 * *patterns.flat_tag_size_m);
  if (patterns.wands.empty()) return patterns.only ? fmt::format("wand {}", *patterns.only) : "any standard wand";
  std::string names;
  for (const Wand& wand : patterns.wands) names += (names.empty() ? "" : ", ") + printable(wand.name);
  return names;
}

}  // namespace

Result<std::unique_ptr<Tracker>> Tracker::start(const TrackerSettings& settings, const Clock& clock,
                                                InspectionService* inspection) {
  TRY_ASSIGN(tags::TagSearch search, tags::TagSearch::create(settings.detector));
  auto camera = devices::make_camera(settings.camera, clock);
  if (!camera && camera.error().code() == ErrorCode::kInvalidArgument) return std::move(camera).error();
  TRY_ASSIGN(std::unique_ptr<TourLink> link, TourLink::open(settings.tour));
  if (!settings.osc.empty() || !settings.vrpn.empty()) {
    TRY_ASSIGN(PoseSender speaker, PoseSender::open(settings.osc, settings.vrpn, "Cyclorama0"));
    link->also_send_to(std::move(speaker));
  }
  inspection->set_fact("camera", settings.camera);
  inspection->set_fact("tour", settings.tour);
  inspection->set_fact("pattern", settings.steer_by == SteerBy::kBody
                                      ? fmt::format("none: by the body, {:.1f} m away", settings.body.mark_distance_m)
                                      : describe(settings.tracking.patterns));
  return std::unique_ptr<Tracker>(new Tracker(settings, clock, inspection, camera ? *std::move(camera) : nullptr,
                                              std::move(search), std::move(link)));
}

Tracker::Tracker(const TrackerSettings& settings, const Clock& clock, InspectionService* inspection,
                 std::unique_ptr<camera::Camera> first_camera, tags::TagSearch search, std::unique_ptr<TourLink> link)
    : settings_(settings),
      clock_(clock),
      inspection_(*inspection),
      search_(std::move(search)),
      body_(settings.steer_by == SteerBy::kBody
                ? std::optional<BodyTracker>(std::in_place, settings.body, settings.background)
                : std::nullopt),
      link_(std::move(link)),
      first_camera_(std::move(first_camera)),
      capture_(
          [this]() -> Result<std::unique_ptr<camera::Camera>> {
            if (first_camera_ != nullptr) return std::move(first_camera_);
            return devices::make_camera(settings_.camera, clock_);
          },
          clock),
      detect_alive_at_(clock.now()),
      counted_at_(clock.now()),
      thread_([this](const std::stop_token& stop) {
        pthread_setname_np(pthread_self(), "detect");
        detect(stop);
      }) {
  static_cast<void>(inspection_.is_watched(kPicture));  // Registers the picture's name for GetStatus.
}

Tracker::~Tracker() {
  thread_.request_stop();
  thread_.join();
}

void Tracker::detect(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    detect_alive_at_ = clock_.now();
    const auto frame = capture_.frames().take_before(SteadyClock().now() + kLookAround);
    if (!frame || (*frame)->pixels.empty()) continue;
    body_ ? handle_body(**frame) : handle(**frame);
  }
}

void Tracker::handle(const camera::CameraFrame& frame) {
  const TimePoint taken_at = clock_.now();
  auto found = search_.search(frame.pixels);
  const TimePoint found_at = clock_.now();
  const std::vector<tags::TagDetection> detections = found ? *std::move(found) : std::vector<tags::TagDetection>{};
  const Pinhole lens = lens_for(settings_.lens, frame.pixels.width(), frame.pixels.height());
  TrackingResult result =
      track(settings_.tracking, tracking_, straight_tags(detections, lens), lens, frame.captured_at);
  tracking_ = result.state;

  wire::TrackedPose pose = pose_of(frame, result.tag);
  pose.set_back(std::ranges::any_of(detections, [](const tags::TagDetection& tag) { return tag.id == kBackTag; }));
  add_stage("capture", taken_at - frame.captured_at, &inspection_, &pose);
  add_stage("detect", found_at - taken_at, &inspection_, &pose);
  add_stage("pose", clock_.now() - found_at, &inspection_, &pose);
  link_->send(std::move(pose));
  ++pictures_;
  followed_ = result.tag ? result.tag->wand.id() : -1;
  report(frame, result, lens, detections);
}

std::vector<tags::TagDetection> Tracker::straight_tags(const std::vector<tags::TagDetection>& seen,
                                                       const Pinhole& lens) {
  if (!settings_.lens.calibrated) return seen;
  const auto calibrated = calibration::lens_for_picture(*settings_.lens.calibrated, lens.width_px, lens.height_px);
  const auto brown = calibrated ? calibrated->brown() : Result<calibration::BrownLens>(calibrated.error());
  does_lens_fit_ = brown.has_value();
  return brown ? tags::straightened(seen, *brown, lens) : seen;
}

void Tracker::handle_body(const camera::CameraFrame& frame) {
  const TimePoint taken_at = clock_.now();
  const Pinhole lens = lens_for(settings_.lens, frame.pixels.width(), frame.pixels.height());
  const std::optional<BodyPose> body = body_->update(frame.pixels, lens, frame.captured_at);
  const TimePoint found_at = clock_.now();
  wire::TrackedPose pose = pose_of(frame);
  pose.set_found(body.has_value());
  if (body) {
    pose.set_body(true);
    set_pose(T_camera_body(*body), &pose);
    add_covariance(covariance_of(*body), &pose);
    pose.set_probability(1.0);
    inspection_.count("pictures_with_a_visitor");
    inspection_.set_gauge("distance_m", body->depth_m);
    inspection_.set_gauge("right_m", -body->x_m);
    inspection_.set_gauge("lean_deg", body->lean_rad * 180.0 / std::numbers::pi);
  }
  add_stage("capture", taken_at - frame.captured_at, &inspection_, &pose);
  add_stage("detect", found_at - taken_at, &inspection_, &pose);
  add_stage("pose", clock_.now() - found_at, &inspection_, &pose);
  link_->send(std::move(pose));
  ++pictures_;
  body_state_ = body_->state();
  inspection_.count("pictures");
  if (inspection_.is_watched(kPicture))
    inspection_.set_picture(kPicture, std::make_shared<const RgbImage>(body_->drawn(frame.pixels)));
}

wire::TrackedPose Tracker::pose_of(const camera::CameraFrame& frame) const {
  wire::TrackedPose pose;
  pose.set_camera(settings_.name.empty() ? capture_.camera_id() : settings_.name);
  pose.set_sequence(frame.sequence);
  pose.set_shutter_ns(to_nanoseconds(frame.captured_at));
  return pose;
}

wire::TrackedPose Tracker::pose_of(const camera::CameraFrame& frame, const std::optional<TrackedTag>& tag) const {
  wire::TrackedPose pose = pose_of(frame);
  pose.set_found(tag.has_value());
  if (!tag) return pose;
  pose.set_tag(static_cast<std::uint32_t>(tag->wand.id()));
  set_pose(tag->T_camera_tag, &pose);
  add_covariance(tag->covariance, &pose);
  pose.set_probability(tag->chosen.probability);
  return pose;
}

void Tracker::report(const camera::CameraFrame& frame, const TrackingResult& result, const Pinhole& lens,
                     std::span<const tags::TagDetection> detections) {
  inspection_.set_gauge("tags_found", static_cast<double>(detections.size()));
  inspection_.count("pictures");
  if (result.tag) {
    inspection_.count("pictures_with_the_tag");
    inspection_.set_gauge("distance_m", result.tag->T_camera_tag.translation().z());
    inspection_.set_gauge("yaw_deg", yaw_rad(result.tag->T_camera_tag) * 180.0 / std::numbers::pi);
    inspection_.set_gauge("tags_used", static_cast<double>(result.tag->seen.size()));
    inspection_.set_gauge("turn_deviation_deg",
                          std::sqrt(result.tag->covariance.topLeftCorner<3, 3>().trace()) * 180.0 / std::numbers::pi);
    inspection_.set_gauge("reprojection_px", result.tag->chosen.pose.reprojection_px);
    inspection_.set_gauge("pose_probability", result.tag->chosen.probability);
  }
  if (!inspection_.is_watched(kPicture)) return;
  const TrackedTag* const tag = result.tag ? &*result.tag : nullptr;
  inspection_.set_picture(kPicture,
                          std::make_shared<const RgbImage>(draw_overlay(frame.pixels, detections, tag, lens)));
}

bool Tracker::supervise() {
  const TimePoint now = clock_.now();
  const double elapsed_s = to_seconds(now - counted_at_);
  const std::uint64_t pictures = pictures_;
  const double rate = elapsed_s > 0.0 ? static_cast<double>(pictures - counted_pictures_) / elapsed_s : 0.0;
  counted_pictures_ = pictures;
  counted_at_ = now;
  inspection_.set_gauge("frames_per_second", rate);
  inspection_.set_gauge("pictures_dropped", static_cast<double>(capture_.dropped()));
  inspection_.set_gauge("poses_sent", static_cast<double>(link_->sent()));
  inspection_.set_gauge("tour_connected", link_->is_connected() ? 1.0 : 0.0);

  const std::string problem = capture_.problem();
  const int followed = followed_;
  std::string sentence = !problem.empty() ? fmt::format("No pictures: {}.", problem)
                         : settings_.steer_by == SteerBy::kBody
                             ? fmt::format("By the body: {}, {:.1f} pictures per second.", body_state_.load(), rate)
                         : followed >= 0 ? fmt::format("Follows tag {}, {:.1f} pictures per second.", followed, rate)
                                         : fmt::format("Sees no tag, {:.1f} pictures per second.", rate);
  if (!does_lens_fit_) sentence += " The lens was calibrated for pictures of another shape and is left aside.";
  if (!link_->is_connected()) sentence += fmt::format(" The tour at {} does not answer.", settings_.tour);
  state_ = sentence;
  inspection_.set_state(std::move(sentence), problem.empty() && link_->is_connected());
  return now - capture_.alive_at() < kStuckAfter && now - detect_alive_at_.load() < kStuckAfter;
}

}  // namespace cyclorama::tracker
