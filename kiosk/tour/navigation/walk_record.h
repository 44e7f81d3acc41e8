// SPDX-License-Identifier: Apache-2.0
/// File format of a recorded walk: every event with its time, and after each tick the resulting view. The file consists
/// of lines of words; numbers have the fewest digits that restore the same bits.
///
///   cyclorama-walk 3
///   limits FORWARD SIDEWAYS TURN ACCELERATION JERK TURN_ACCELERATION TURN_JERK
///   tag NEUTRAL_DISTANCE NEUTRAL_RIGHT YAW_DEAD YAW_FULL SIDE_DEAD SIDE_FULL DISTANCE_DEAD DISTANCE_FULL
///   body MARK_DISTANCE NEUTRAL_RIGHT LEAN_DEAD LEAN_FULL SIDE_DEAD SIDE_FULL DISTANCE_DEAD DISTANCE_FULL
///   times SMOOTHING GUIDE_AFTER MAX_TURN TURN_PAUSE                        all times in nanoseconds
///
///   open AT NAME SCALE X Z HEADING POLYGONS (CORNERS (X Z)...)... STOPS (X Z HEADING STAY)...
///        WAYS (FROM TO IS_CUT POSITIONS (X Z)...)... PACE TURN_PACE REDUCED_MOTION      the whole in one line
///   pose AT TRACKER SEQUENCE SHUTTER lost
///   pose AT TRACKER SEQUENCE SHUTTER X Y Z QW QX QY QZ                     likewise `body`: a visitor without a tag
///   left AT TRACKER
///   keys AT FORWARD RIGHT TURN
///   led AT STOP                                                            likewise `cut`
///   held AT
///   tick AT X Z HEADING RIGHT FORWARD TURN STEERER                         the resulting view; then further events
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "kiosk/tour/navigation/view_meter.h"
#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama::tour {

/// View that results from a tick.
struct RecordedView {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();
  double turn_rate_rad_per_s = 0.0;
  SteeringSource steering_source = SteeringSource::kNobody;

  [[nodiscard]] static RecordedView of(const Navigation& navigation);
  /// Compares bit by bit.
  [[nodiscard]] bool is_same(const RecordedView& other) const;
};

struct WalkEntry {
  WalkEvent event;
  TimePoint at{};
  std::optional<RecordedView> view;  ///< Set for ticks only.
  std::size_t line = 0;
};

struct WalkRecord {
  NavigationSettings settings;
  std::vector<WalkEntry> entries;
};

/// Returns the first lines of a record. Pure.
[[nodiscard]] std::string record_head(const NavigationSettings& settings);
/// Returns the line of an event; `walk` is the state after it. Bytes of scene names that a file cannot contain are
/// escaped. Pure.
[[nodiscard]] std::string record_line(const WalkEvent& event, TimePoint at, const VisitWalk& walk);

/// Errors: kBadData with "FILE:LINE: ...". A last line without its newline, as a killed process leaves it, is ignored.
Result<WalkRecord> parse_walk_record(std::string_view text, const std::string& name);

struct WalkReplay {
  std::size_t ticks = 0;
  std::size_t poses = 0;
  Duration length{};
  ViewPeaks peaks;
  /// Line number and both views where a view first differs from the recorded one; nothing if all are equal to the bit.
  std::optional<std::string> difference;
};
[[nodiscard]] WalkReplay replayed(const WalkRecord& record);

}  // namespace cyclorama::tour
