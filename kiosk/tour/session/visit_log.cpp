// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/visit_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/check.h"
#include "common/base/text.h"
#include "common/language/marked_texts.h"
#include "common/wire/payload.h"

namespace cyclorama::tour {
namespace {

constexpr std::size_t kMaxStages = 48;
constexpr std::size_t kMaxReasons = 24;
constexpr std::size_t kMaxNameLength = 100;
constexpr auto kRateWindow = std::chrono::seconds(5);
/// Upper bound of a plausible stage time: a longer stage was interrupted, or the difference between two machines'
/// clocks is wrong.
constexpr double kMaxStageS = 60.0;

/// Returns the printable name while there is room for it, otherwise a name that all further names share.
std::string bounded(const std::string& name, std::size_t max, std::set<std::string>* names) {
  std::string shown = printable(name, kMaxNameLength);
  if (shown.empty()) shown = "unnamed";
  if (names->contains(shown)) return shown;
  if (names->size() >= max) return "other";
  names->insert(shown);
  return shown;
}

Duration from_seconds(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

VisitLog::VisitLog(InspectionService* inspection) : inspection_(*inspection) {
  CHECK(inspection != nullptr);
  inspection_.set_gauge("frames", 0.0);
  inspection_.set_gauge("frames_per_second", 0.0);
}

void VisitLog::add_stages(const google::protobuf::RepeatedPtrField<wire::StageTime>& stages) {
  for (const wire::StageTime& stage : stages) {
    if (!(stage.seconds() >= 0.0 && stage.seconds() <= kMaxStageS)) continue;
    inspection_.add_stage_time(bounded(stage.name(), kMaxStages, &stage_names_), from_seconds(stage.seconds()));
  }
}

void VisitLog::add_pose(const wire::TrackedPose& pose) {
  const std::lock_guard lock(mutex_);
  add_stages(pose.stages());
}

void VisitLog::add_view(const wire::View& view, TimePoint now, std::optional<TimePoint> pose_received_at) {
  const std::lock_guard lock(mutex_);
  if (pose_received_at) inspection_.add_stage_time("steer", now - *pose_received_at);
  refinement_.reset();
  sent_[view.number()] = {view.shutter_ns(), now, view.panorama().width_px(), false, false, false};
  if (sent_.size() > kMaxSent) sent_.erase(sent_.begin());
}

void VisitLog::add_begin(const wire::View& view) {
  const std::lock_guard lock(mutex_);
  const auto sent = sent_.find(view.number());
  if (sent == sent_.end() || sent->second.ended || sent->second.width_px == 0) return;
  inspection_.set_gauge("picture_scale",
                        static_cast<double>(view.panorama().width_px()) / static_cast<double>(sent->second.width_px));
}

void VisitLog::add_tile(const wire::Tile& tile) {
  const std::lock_guard lock(mutex_);
  frame_bytes_ += static_cast<double>(payload_bytes(tile));
}

void VisitLog::add_end(const wire::FrameEnd& end, TimePoint now) {
  const std::lock_guard lock(mutex_);
  const double bytes = std::exchange(frame_bytes_, 0.0);
  if (!end.complete()) {
    if (end.late()) inspection_.count("late_frames");
    drop_view(end.view_number(), end.reason().empty() ? "the farm gave no reason" : end.reason());
    return;
  }
  completed_at_ = now;
  inspection_.set_gauge("samples_per_pixel", end.samples());
  const auto sent = sent_.find(end.view_number());
  const bool is_refined = sent != sent_.end() && std::exchange(sent->second.ended, true);
  refinement_.reset();
  if (is_refined) {
    const bool rests = end.samples() >= end.reference_samples();
    refinement_ = rests
                      ? fmt::format(translatable("at rest with {} samples"), end.samples())
                      : fmt::format(translatable("refining {} of {} samples"), end.samples(), end.reference_samples());
    inspection_.count("refined_frames");
    return;
  }
  add_stages(end.stages());
  if (sent != sent_.end()) inspection_.add_stage_time("farm_round_trip", now - sent->second.asked_at);
  bytes_.add(bytes);
  inspection_.set_gauge("bytes_per_frame", std::round(bytes_.mean()));
  if (end.balance_efficiency() > 0.0 && end.balance_efficiency() <= 1.0) {
    balance_.add(end.balance_efficiency());
    inspection_.set_gauge("balance_efficiency", balance_.mean());
  }
  inspection_.set_gauge("nodes", end.nodes());
}

void VisitLog::add_presented(const wire::FramePresented& presented, TimePoint now) {
  const std::lock_guard lock(mutex_);
  add_stages(presented.stages());
  const auto sent = sent_.find(presented.view_number());
  if (sent == sent_.end() || sent->second.presented) return;
  sent->second.presented = true;
  newest_presented_ = std::max(newest_presented_, presented.view_number());
  presented_at_.push_back(now);
  inspection_.count("frames");
  if (sent->second.shutter_ns <= 0 || presented.presented_ns() <= sent->second.shutter_ns) return;
  const double seconds = 1e-9 * static_cast<double>(presented.presented_ns() - sent->second.shutter_ns);
  if (seconds <= kMaxStageS) inspection_.add_stage_time("shutter_to_photon", from_seconds(seconds));
}

void VisitLog::add_dropped(const std::string& reason, std::uint64_t frames) {
  const std::lock_guard lock(mutex_);
  drop(reason, frames);
}

void VisitLog::add_not_shown(const wire::FrameDropped& dropped) {
  const std::lock_guard lock(mutex_);
  drop_view(dropped.view_number(), dropped.reason());
}

void VisitLog::drop_view(std::uint64_t number, const std::string& reason) {
  const auto sent = sent_.find(number);
  if (sent != sent_.end() && std::exchange(sent->second.dropped, true)) return;
  drop(reason, 1);
}

void VisitLog::drop(const std::string& reason, std::uint64_t frames) {
  if (frames == 0) return;
  inspection_.count("dropped: " + bounded(reason, kMaxReasons, &drop_reasons_), static_cast<double>(frames));
}

double VisitLog::rate(TimePoint now) {
  while (!presented_at_.empty() && now - presented_at_.front() > kRateWindow) presented_at_.pop_front();
  if (presented_at_.size() < 2) return 0.0;
  // Covers the time between the oldest and the newest, so that a start or a stop does not look like a slow rate for
  // five seconds.
  const Duration span = std::max(presented_at_.back() - presented_at_.front(), now - presented_at_.back());
  return static_cast<double>(presented_at_.size() - 1) / std::max(to_seconds(span), 1e-3);
}

/// Ignores the frames after the newest one that was shown, since they may still be shown.
double VisitLog::wasted_share() const {
  const auto end = sent_.upper_bound(newest_presented_);
  const auto all = std::distance(sent_.begin(), end);
  const auto wasted = std::count_if(sent_.begin(), end, [](const auto& sent) { return !sent.second.presented; });
  return all == 0 ? 0.0 : static_cast<double>(wasted) / static_cast<double>(all);
}

double VisitLog::frames_per_second(TimePoint now) {
  const std::lock_guard lock(mutex_);
  return rate(now);
}

void VisitLog::refresh(TimePoint now) {
  const std::lock_guard lock(mutex_);
  inspection_.set_gauge("frames_per_second", rate(now));
  inspection_.set_gauge("wasted_frames_share", wasted_share());
}

std::optional<std::string> VisitLog::refinement() const {
  const std::lock_guard lock(mutex_);
  return refinement_;
}

std::optional<TimePoint> VisitLog::frame_completed_at() const {
  const std::lock_guard lock(mutex_);
  return completed_at_;
}

}  // namespace cyclorama::tour
