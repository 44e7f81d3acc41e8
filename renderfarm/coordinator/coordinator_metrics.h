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

/// The coordinator's numbers for the operator. What it tells the inspection service:
///
///   stages   queue, plan, fan_out, render, encode, farm, overhead of each whole frame of a moving picture; relay of
///   each
///            tile (docs/reference/frame-timing.md)
///   gauges   frames, refined_frames, late_frames, given_up_frames: of all sessions since the start; frames_per_second,
///            rays_per_second: of the last second or so; nodes, sessions
///            nodes_ready: nodes that have the farm's first scene
///   facts    scene: the farm's first; triangles: of that, instances counted; last_frame_given_up: why
///   tables   sessions, nodes (renderfarm/watch/farm_tables.h)
///
/// The same goes into the metrics. Thread-bound: the coordinator's loop; what it feeds is borrowed and thread-safe.
class CoordinatorMetrics {
 public:
  CoordinatorMetrics(InspectionService& inspection, watch::FarmMetrics& metrics)
      : inspection_(inspection), metrics_(metrics) {}

  void add(const FrameReport& report);
  /// One step of a frame, as docs/reference/frame-timing.md names it.
  void add_stage(const std::string& stage, double seconds);
  /// The state at each call; tables and rates once a second.
  void update(const CoordinatorState& state, TimePoint now);

 private:
  void add_to_session(const FrameReport& report);
  void add_loads(const FrameReport& report);
  /// What the meters know of sessions and nodes, put into the overview; of those that are gone they know no more.
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
