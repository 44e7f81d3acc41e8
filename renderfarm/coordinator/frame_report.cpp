// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/frame_report.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::coordinator {
namespace {

void add_stage(wire::FrameEnd* end, const char* name, double seconds) {
  wire::StageTime* const stage = end->add_stages();
  stage->set_name(name);
  stage->set_seconds(seconds);
}

/// Returns the thread time of the busiest node over its threads, in ms; 0 for a frame that its nodes did not finish.
double rays_ms(const FrameReport& report) {
  if (!report.complete || report.reassigned || report.loads.empty()) return 0.0;
  return 1e3 * *std::ranges::max_element(report.loads);
}

}  // namespace

FrameReport report_of(SessionId id, const Session& session, const FrameInFlight& frame, const NodeTable& nodes,
                      TimePoint now) {
  const FrameAssembly::Summary sum = frame.assembly.summary();
  FrameReport report{id, session.museum, !frame.failure, frame.failure.value_or("")};
  for (const auto& [node, cpu_seconds] : sum.loads) {
    const auto found = nodes.find(node);
    if (found == nodes.end()) continue;
    report.loads.push_back(cpu_seconds / found->second.threads);
    report.nodes.push_back(node);
  }
  report.received_at = frame.received_at;
  report.queue_seconds = to_seconds(frame.turn_began_at - frame.received_at);
  report.plan_seconds = to_seconds(frame.planned_at - frame.turn_began_at);
  report.fan_out_seconds = to_seconds(std::max(frame.fanned_out_at, frame.planned_at) - frame.planned_at);
  report.rays_seconds = sum.away_seconds;
  report.render_seconds = sum.render_seconds;
  report.encode_seconds = sum.encode_seconds;
  report.farm_seconds = to_seconds(now - frame.received_at);
  report.balance_efficiency = balance::balance_efficiency(report.loads);
  report.cpu_seconds = sum.cpu_seconds;
  report.rays = sum.rays;
  report.bytes = frame.bytes;
  report.refined = frame.refines.has_value();
  report.late = frame.late;
  report.reassigned = frame.assembly.was_reassigned();
  report.moved = frame.moved;
  report.view = frame.view;
  if (report.complete && !report.reassigned) report.costs = sum.costs;
  report.samples = static_cast<int>(frame.view.first_sample() + frame.view.samples());
  report.scale = std::sqrt(static_cast<double>(frame.view.panorama().width_px()) * frame.view.panorama().height_px() /
                           static_cast<double>(frame.asked_px));
  if (session.governed) report.budget_ms = session.governed->governor.budget_ms();
  return report;
}

wire::FrameEnd end_of(const Session& session, const FrameInFlight& frame, const FrameReport& report) {
  wire::FrameEnd end;
  end.set_view_number(frame.view.number());
  end.set_tiles(frame.assembly.delivered());
  if (!report.refined) {
    add_stage(&end, "queue", report.queue_seconds);
    add_stage(&end, "plan", report.plan_seconds);
    add_stage(&end, "fan_out", report.fan_out_seconds);
    add_stage(&end, "render", report.render_seconds);
    add_stage(&end, "encode", report.encode_seconds);
    add_stage(&end, "farm", report.farm_seconds);
  }
  end.set_nodes(static_cast<std::uint32_t>(report.loads.size()));
  end.set_balance_efficiency(report.balance_efficiency);
  end.set_complete(report.complete);
  end.set_reason(report.reason);
  end.set_late(report.late);
  end.set_samples(static_cast<std::uint32_t>(report.samples));
  if (session.governed) end.set_reference_samples(static_cast<std::uint32_t>(session.governed->reference_samples));
  return end;
}

WrittenFrame to_be_written(const FrameInFlight& frame, const FrameReport& report) {
  return {frame.view.number(),
          frame.planned_at,
          frame.last_tile_at,
          report.reassigned || (!report.complete && !report.late),
          frame.work,
          rays_ms(report),
          1e-6 * static_cast<double>(frame.asked_px),
          frame.refines ? frame.refines->end - frame.refines->first : 0};
}

}  // namespace cyclorama::coordinator
