// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/head/head_meters.h"

#include <fmt/format.h>

namespace cyclorama {
namespace {
Duration duration_of(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}
}  // namespace

void HeadMeters::add(const FrameReport& report) {
  if (!report.complete) {
    inspection_.count("frames_given_up");
    inspection_.set_fact("last_frame_given_up", report.reason);
    return;
  }
  inspection_.set_gauge("samples_per_pixel", report.samples);
  inspection_.set_gauge("scale", report.scale);
  inspection_.set_gauge("budget_ms", report.budget_ms);
  if (report.refined) {
    inspection_.count("refined_frames");
    rays_ += report.rays;
    return;
  }
  inspection_.add_stage_time("plan", duration_of(report.plan_seconds));
  inspection_.add_stage_time("render", duration_of(report.render_seconds));
  inspection_.add_stage_time("encode", duration_of(report.encode_seconds));
  inspection_.add_stage_time("farm", duration_of(report.farm_seconds));
  inspection_.set_gauge("bytes_per_frame", static_cast<double>(report.bytes));
  inspection_.set_gauge("balance_efficiency", report.balance_efficiency);
  inspection_.count("frames");
  ++frames_;
  rays_ += report.rays;
}

void HeadMeters::add_relay(double seconds) { inspection_.add_stage_time("relay", duration_of(seconds)); }

void HeadMeters::update(const HeadState& state, TimePoint now) {
  inspection_.set_gauge("nodes", static_cast<double>(state.nodes()));
  inspection_.set_gauge("sessions", static_cast<double>(state.sessions()));
  const std::string& scene = state.farm_scenes().front().name;
  inspection_.set_gauge("nodes_ready", static_cast<double>(state.nodes_with(scene)));  // For the default scene.
  inspection_.set_fact("scene", scene);
  if (const wire::SceneDescription* const known = state.description(scene)) {
    inspection_.set_fact("triangles", fmt::format("{}", known->triangles_seen()));
  }
  inspection_.set_state(state.summary(), state.nodes_with(scene) > 0);
  constexpr auto kPeriod = std::chrono::seconds(1);
  if (now - updated_at_ < kPeriod) return;
  const double seconds = updated_at_ == TimePoint{} ? 0.0 : to_seconds(now - updated_at_);
  updated_at_ = now;
  inspection_.set_gauge("frames_per_second", seconds > 0.0 ? std::exchange(frames_, 0) / seconds : 0.0);
  inspection_.set_gauge("rays_per_second",
                        seconds > 0.0 ? static_cast<double>(std::exchange(rays_, 0)) / seconds : 0.0);
}

}  // namespace cyclorama
