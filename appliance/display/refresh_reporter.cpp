// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/refresh_reporter.h"

#include <algorithm>

namespace cyclorama::display {
namespace {
constexpr auto kRatePeriod = std::chrono::seconds(1);
}

RefreshReporter::RefreshReporter(InspectionService* inspection, const std::vector<std::string>& heads)
    : inspection_(*inspection) {
  for (const char* const gauge :
       {"refreshes_per_second", "frames_per_second", "frames_presented", "frames_dropped", "missed_refreshes",
        "bytes_per_frame", "tiles_per_frame", "tiles_decoded_per_frame", "refreshes_past_guard_band", "attract_share",
        "frames_late", "headings_late", "poses_shown", "poses_per_second", "eye_moved_m", "eye_missed_m",
        "frames_without_depth"}) {
    inspection_.set_gauge(gauge, 0.0);
  }
  for (const std::string& name : heads) {
    heads_.push_back({"refresh_interval: " + name,
                      "picture_age: " + name,
                      "late_refreshes: " + name,
                      "missed_refreshes: " + name,
                      "lit: " + name,
                      false,
                      {}});
    for (const std::string* const gauge : {&heads_.back().late, &heads_.back().missed, &heads_.back().lit})
      inspection_.set_gauge(*gauge, 0.0);
  }
}

std::optional<wire::FramePresented> RefreshReporter::take(const RefreshEvent& event) {
  const TimePoint shown_at = event.presented.at;
  if (last_refresh_ && event.presented.refresh > *last_refresh_ + 1) {
    inspection_.count("missed_refreshes", static_cast<double>(event.presented.refresh - *last_refresh_ - 1));
  }
  last_refresh_ = event.presented.refresh;
  ++refreshes_;
  inspection_.set_gauge("attract_share", event.attract_share);
  inspection_.set_gauge("eye_moved_m", event.moved_m);
  inspection_.set_gauge("eye_missed_m", event.missed_m);
  if (event.heading_rad != last_heading_rad_ || event.eye_m != last_eye_m_) {
    ++poses_;
    inspection_.count("poses_shown");
  }
  last_heading_rad_ = event.heading_rad;
  last_eye_m_ = event.eye_m;
  if (event.is_past_guard) inspection_.count("refreshes_past_guard_band");
  if (event.heading_shutter_ns != 0) {
    inspection_.add_stage_time("heading_to_photon", shown_at - from_nanoseconds(event.heading_shutter_ns));
  }
  take_step(event);
  if (!event.is_first_of_frame) return std::nullopt;

  ++frames_;
  inspection_.count("frames_presented");
  inspection_.set_gauge("bytes_per_frame", static_cast<double>(event.frame_bytes));
  inspection_.set_gauge("tiles_per_frame", event.frame_tiles);
  inspection_.set_gauge("tiles_decoded_per_frame", event.frame_decoded);
  if (event.frame_shutter_ns != 0) {
    inspection_.add_stage_time("shutter_to_photon", shown_at - from_nanoseconds(event.frame_shutter_ns));
  }
  wire::FramePresented report;
  report.set_view_number(event.frame_number);
  report.set_presented_ns(to_nanoseconds(shown_at));
  const auto report_stage = [&](const char* name, Duration duration) {
    wire::StageTime* const stage = report.add_stages();
    stage->set_name(name);
    stage->set_seconds(to_seconds(duration));
  };
  const auto add_stage = [&](const char* name, Duration duration) {
    inspection_.add_stage_time(name, duration);
    report_stage(name, duration);
  };
  if (event.heading_shutter_ns != 0) {
    report_stage("heading_to_photon", shown_at - from_nanoseconds(event.heading_shutter_ns));
  }
  add_stage("decode", event.decoded_at - event.begun_at);
  add_stage("wait", event.drawing_at - event.decoded_at);
  add_stage("draw", shown_at - event.drawing_at);
  return report;
}

void RefreshReporter::take_step(const RefreshEvent& event) {
  if (event.synchronised_refresh && last_synchronised_refresh_) {
    const std::int64_t late = event.late(event.frame_due);
    step_.add(event.presented.at, std::max<std::int64_t>(0, *event.synchronised_refresh - *last_synchronised_refresh_),
              late);
    if (late > 0) inspection_.count("frames_late");
    if (event.late(event.heading_due) > 0) inspection_.count("headings_late");
  }
  last_synchronised_refresh_ = event.synchronised_refresh;
}

void RefreshReporter::take(const HeadRefresh& refresh) {
  Head& head = heads_.at(refresh.head);
  const bool is_lit = refresh.shown.light != output::HeadShown::Light::kDark;
  if (is_lit != head.is_lit) inspection_.set_gauge(head.lit, is_lit ? 1.0 : 0.0);
  head.is_lit = is_lit;
  if (refresh.picture_at != TimePoint{} && refresh.shown.light == output::HeadShown::Light::kNew)
    inspection_.add_stage_time(head.age, refresh.shown.at - refresh.picture_at);
  const std::optional<output::PictureStep> step = head.pacing.take(refresh.shown);
  if (!step) return;
  inspection_.add_stage_time(head.interval, step->interval);
  if (step->is_late) inspection_.count(head.late);
  if (step->missed > 0) inspection_.count(head.missed, static_cast<double>(step->missed));
}

void RefreshReporter::output_lost() {
  for (std::size_t head = 0; head < heads_.size(); ++head) take(HeadRefresh{head, {}, {}});
}

void RefreshReporter::frame_dropped(const std::string& reason) {
  inspection_.count("frames_dropped");
  inspection_.set_fact("last_drop", reason);
}

void RefreshReporter::frame_without_depth(const std::string& trouble) {
  inspection_.count("frames_without_depth");
  inspection_.set_fact("last_depth_trouble", trouble);
}

void RefreshReporter::tick(TimePoint now) {
  if (counted_since_ == TimePoint{}) counted_since_ = now;
  const Duration counted = now - counted_since_;
  if (counted < kRatePeriod) return;
  frames_per_second_ = frames_ / to_seconds(counted);
  inspection_.set_gauge("refreshes_per_second", refreshes_ / to_seconds(counted));
  inspection_.set_gauge("frames_per_second", frames_per_second_);
  if (const auto share = synchronised_share(now)) inspection_.set_gauge("synchronised_percent", 100.0 * *share);
  inspection_.set_gauge("poses_per_second", poses_ / to_seconds(counted));
  refreshes_ = 0;
  frames_ = 0;
  poses_ = 0;
  counted_since_ = now;
}

}  // namespace cyclorama::display
