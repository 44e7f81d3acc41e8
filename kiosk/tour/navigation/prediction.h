// SPDX-License-Identifier: Apache-2.0
/// Predicts where the visitor will be when a picture that is requested now is shown.
#pragma once

#include "kiosk/tour/navigation/visit_walk.h"

namespace cyclorama::tour {

/// Maximum time that is predicted. Beyond it a visitor has usually changed the command, and a picture from the wrong
/// position is no better than an old one.
inline constexpr Duration kMaxAhead = std::chrono::seconds(1);
/// Step of the prediction, equal to the tour's step, so that a steady walk is predicted exactly.
inline constexpr Duration kWalkStep = std::chrono::microseconds(16666);

/// Returns the visitor at `at` if the present input holds: keys stay pressed and a wand in sight stays where it is; the
/// guide goes on by itself, and a lost wand glides to rest. The prediction continues the walk itself, so the result
/// obeys the same limits and lies in the walkable area. `at` is clamped to kMaxAhead after the walk's last step; for a
/// time before that step, or a walk at rest, the result is the present visitor. Pure: `walk` is not changed.
[[nodiscard]] Walker predicted(const VisitWalk& walk, TimePoint at, const NavigationSettings& settings);

/// Returns true if a visitor can leave the start of this site under these limits. In an area no wider than a step there
/// is nowhere to walk to, so pictures need no depth.
[[nodiscard]] bool can_walk(const Site& site, const WalkLimits& limits);

}  // namespace cyclorama::tour
