// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/base/clock.h"
#include "common/wire/inspection_service.h"
#include "renderfarm/coordinator/coordinator_state.h"
#include "renderfarm/coordinator/delegate.h"
#include "renderfarm/watch/farm_metrics.h"

namespace cyclorama::coordinator {

/// Collects the coordinator's metrics for the operator. The inspection service gets:
///
///   stages   queue, plan, fan_out, render, encode, farm and overhead of each complete frame of a moving picture;
///            relay of each tile (docs/reference/frame-timing.md)
///   gauges   frames, refined_frames, late_frames, given_up_frames: totals of all sessions since the start;
///            frames_per_second, rays_per_second: over about the last second; nodes, sessions;
///            nodes_ready: nodes that have loaded the farm's first scene
///   facts    scene: the farm's first scene; triangles: its triangles, instances included; last_frame_given_up: the
///            reason
///   tables   sessions, nodes (renderfarm/watch/farm_tables.h)
///
/// The farm's metrics get the same values. Bound to the coordinator's loop. Both sinks are borrowed; they are
/// thread-safe.
class CoordinatorMetrics {
 public:
  CoordinatorMetrics(InspectionService& inspection, watch::FarmMetrics& metrics)
      : inspection_(inspection), metrics_(metrics) {}

  void add(const FrameReport& report);
  /// Adds the time of one stage of a frame; docs/reference/frame-timing.md lists the names.
  void add_stage(const std::string& stage, double seconds);
  /// Publishes the state at each call; publishes tables and rates once a second.
  void update(const CoordinatorState& state, TimePoint now);

 private:
  void add_to_session(const FrameReport& report);
  void add_loads(const FrameReport& report);
  /// Adds the measured values of sessions and nodes to the overview, and drops the values of peers that are gone.
  void complete(watch::FarmOverview* farm, double seconds);

  InspectionService& inspection_;
  watch::FarmMetrics& metrics_;
  TimePoint updated_at_{};
  int frames_ = 0;
  std::uint64_t rays_ = 0;
  struct Session {
    watch::WatchedSession seen{};
    int frames_since_update = 0;
  };
  std::map<std::uint64_t, Session> sessions_;
  std::map<std::uint64_t, double> load_shares_;
};

}  // namespace cyclorama::coordinator
