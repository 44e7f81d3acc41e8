// SPDX-License-Identifier: Apache-2.0
/// A walk in a file: every event with its time, and after each tick the view that it led to. Lines of words, numbers in
/// the fewest digits that give the same bits again.
///
///   cyclorama-walk 2
///   limits FORWARD SIDEWAYS TURN ACCELERATION JERK TURN_ACCELERATION TURN_JERK
///   tag NEUTRAL_DISTANCE NEUTRAL_RIGHT YAW_DEAD YAW_FULL SIDE_DEAD SIDE_FULL DISTANCE_DEAD DISTANCE_FULL
///   body STAND NEUTRAL_RIGHT LEAN_DEAD LEAN_FULL SIDE_DEAD SIDE_FULL DISTANCE_DEAD DISTANCE_FULL
///   times SMOOTHING GUIDE_AFTER TURN_LONGEST TURN_PAUSE                    all times in nanoseconds
///
///   open AT NAME SCALE X Z HEADING POLYGONS (CORNERS (X Z)...)... STOPS (X Z HEADING)...
///   pose AT TRACKER SEQUENCE SHUTTER lost
///   pose AT TRACKER SEQUENCE SHUTTER X Y Z QW QX QY QZ                     and so for `body`: no pattern
///   left AT TRACKER
///   keys AT FORWARD RIGHT TURN
///   tick AT X Z HEADING RIGHT FORWARD TURN STEERER                         where it led; then more of these
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "kiosk/tour/navigation/view_meter.h"
#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama {

/// What a tick led to.
struct RecordedView {
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;
  Eigen::Vector2d velocity_m_per_s = Eigen::Vector2d::Zero();
  double turn_rate_rad_per_s = 0.0;
  Steerer steerer = Steerer::kNobody;

  [[nodiscard]] static RecordedView of(const Navigation& navigation);
  /// To the bit.
  [[nodiscard]] bool is_same(const RecordedView& other) const;
};

struct WalkEntry {
  WalkEvent event;
  TimePoint at{};
  std::optional<RecordedView> view;  ///< Of ticks.
  std::size_t line = 0;
};

struct WalkRecord {
  NavigationSettings settings;
  std::vector<WalkEntry> entries;
};

/// The lines of a record, as they come. Scene names are kept as far as files can hold them. Pure.
[[nodiscard]] std::string record_head(const NavigationSettings& settings);
/// `walk` is the one after the event.
[[nodiscard]] std::string record_line(const WalkEvent& event, TimePoint at, const VisitWalk& walk);

/// kBadData  "FILE:LINE: ..."; a last line without its end, as a process leaves it that was killed, is passed over.
Result<WalkRecord> parse_walk_record(std::string_view text, const std::string& name);

struct WalkReplay {
  std::size_t ticks = 0;
  std::size_t poses = 0;
  Duration length{};
  ViewPeaks peaks;
  /// The first view that is not the recorded one: its line, and both. Nothing: the same to the bit.
  std::optional<std::string> difference;
};
[[nodiscard]] WalkReplay replayed(const WalkRecord& record);

}  // namespace cyclorama
