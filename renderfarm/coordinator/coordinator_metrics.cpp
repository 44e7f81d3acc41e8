// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/coordinator_metrics.h"

#include <fmt/format.h>

#include <algorithm>

#include "renderfarm/watch/farm_tables.h"

namespace cyclorama::coordinator {
namespace {

constexpr Duration kPeriod = std::chrono::seconds(1);
/// Weight of a new value in a node's mean share of a frame; the mean covers about twenty frames.
constexpr double kNewShare = 0.05;

Duration duration_of(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

watch::FrameFigures::Outcome outcome_of(const FrameReport& report) {
  if (report.late) return watch::FrameFigures::Outcome::kLate;
  if (!report.complete) return watch::FrameFigures::Outcome::kGivenUp;
  return report.refined ? watch::FrameFigures::Outcome::kRefined : watch::FrameFigures::Outcome::kWhole;
}

}  // namespace

void CoordinatorMetrics::add_stage(const std::string& stage, double seconds) {
  inspection_.add_stage_time(stage, duration_of(seconds));
  metrics_.add_stage(stage, seconds);
}

void CoordinatorMetrics::add(const FrameReport& report) {
  metrics_.add({report.museum, outcome_of(report), report.bytes, report.rays, report.reassigned, report.moved});
  add_to_session(report);
  rays_ += report.rays;
  if (!report.complete) {
    inspection_.count(report.late ? "late_frames" : "given_up_frames");
    inspection_.set_fact("last_frame_given_up", report.reason);
    return;
  }
  if (report.refined) {
    inspection_.count("refined_frames");
    return;
  }
  add_loads(report);
  add_stage("queue", report.queue_seconds);
  add_stage("plan", report.plan_seconds);
  add_stage("fan_out", report.fan_out_seconds);
  add_stage("render", report.render_seconds);
  add_stage("encode", report.encode_seconds);
  add_stage("farm", report.farm_seconds);
  inspection_.count("frames");
  ++frames_;
}

void CoordinatorMetrics::add_to_session(const FrameReport& report) {
  Session& session = sessions_[static_cast<std::uint64_t>(report.session)];
  watch::WatchedSession& seen = session.seen;
  switch (outcome_of(report)) {
    case watch::FrameFigures::Outcome::kWhole:
      ++seen.frames;
      ++session.frames_since_update;
      seen.frame_ms = 1e3 * report.farm_seconds;
      seen.balance_efficiency = report.balance_efficiency;
      break;
    case watch::FrameFigures::Outcome::kRefined:
      ++seen.refined;
      break;
    case watch::FrameFigures::Outcome::kLate:
      ++seen.late;
      return;
    case watch::FrameFigures::Outcome::kGivenUp:
      ++seen.given_up;
      return;
  }
  seen.samples_per_pixel = report.samples;
  seen.scale = report.scale;
  seen.width_px = static_cast<int>(report.view.panorama().width_px());
  seen.height_px = static_cast<int>(report.view.panorama().height_px());
  seen.bytes_per_frame = static_cast<double>(report.bytes);
}

void CoordinatorMetrics::add_loads(const FrameReport& report) {
  const double max = report.loads.empty() ? 0.0 : std::ranges::max(report.loads);
  if (max <= 0.0) return;
  for (std::size_t i = 0; i < report.nodes.size(); ++i) {
    const double share = report.loads[i] / max;
    const auto [entry, is_new] = load_shares_.try_emplace(static_cast<std::uint64_t>(report.nodes[i]), share);
    entry->second += kNewShare * (share - entry->second);
  }
}

void CoordinatorMetrics::complete(watch::FarmOverview* farm, double seconds) {
  std::map<std::uint64_t, Session> sessions;
  for (watch::WatchedSession& session : farm->sessions) {
    Session known = sessions_[session.id];
    known.seen.id = session.id;
    known.seen.museum = std::move(session.museum);
    known.seen.scene = std::move(session.scene);
    known.seen.budget_ms = session.budget_ms;
    known.seen.frames_per_second = seconds > 0.0 ? std::exchange(known.frames_since_update, 0) / seconds : 0.0;
    session = known.seen;
    sessions[session.id] = std::move(known);
  }
  sessions_ = std::move(sessions);
  std::map<std::uint64_t, double> shares;
  for (watch::WatchedNode& node : farm->nodes) {
    const auto known = load_shares_.find(node.id);
    if (known != load_shares_.end()) shares.insert(*known);
    node.load_share = known == load_shares_.end() ? 0.0 : known->second;
  }
  load_shares_ = std::move(shares);
}

void CoordinatorMetrics::update(const CoordinatorState& state, TimePoint now) {
  const std::string& scene = state.farm_scenes().front().name;
  const bool healthy = state.nodes_with(scene) > 0;
  inspection_.set_state(state.summary(), healthy);
  if (now - updated_at_ < kPeriod) return;
  const double seconds = updated_at_ == TimePoint{} ? 0.0 : to_seconds(now - updated_at_);
  updated_at_ = now;
  inspection_.set_gauge("nodes", static_cast<double>(state.nodes()));
  inspection_.set_gauge("sessions", static_cast<double>(state.sessions()));
  inspection_.set_gauge("nodes_ready", static_cast<double>(state.nodes_with(scene)));
  inspection_.set_fact("scene", scene);
  if (const wire::SceneDescription* const known = state.description(scene)) {
    inspection_.set_fact("triangles", fmt::format("{}", known->triangles_seen()));
  }
  const auto rate = [&](double count) { return seconds > 0.0 ? count / seconds : 0.0; };
  inspection_.set_gauge("frames_per_second", rate(std::exchange(frames_, 0)));
  inspection_.set_gauge("rays_per_second", rate(static_cast<double>(std::exchange(rays_, 0))));
  watch::FarmOverview farm = state.overview();
  farm.healthy = healthy;
  complete(&farm, seconds);
  inspection_.set_table(watch::sessions_table(farm));
  inspection_.set_table(watch::nodes_table(farm));
  metrics_.show(std::move(farm));
}

}  // namespace cyclorama::coordinator
