// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/prediction.h"

#include <algorithm>
#include <utility>

#include "kiosk/tour/navigation/brake.h"

namespace cyclorama::tour {
namespace {

bool is_within(const std::optional<TimePoint>& since, Duration how_long, TimePoint now) {
  return since && now - *since <= how_long;
}

}  // namespace

Walker predicted(const VisitWalk& walk, TimePoint at, const NavigationSettings& settings) {
  const std::optional<TimePoint> began = walk.navigation.advanced_at;
  if (!walk.open || !began || at <= *began) return walk.navigation.walker;
  Navigation state = walk.navigation;
  const bool has_keys = is_within(state.keys_at, kKeysHeld, *began) && !state.keys_command.is_rest();
  const bool has_tag = is_within(state.tag_seen_at, kTagHeld, *began);
  const TimePoint end = std::min(at, *began + kMaxAhead);
  for (TimePoint now = *began; now < end;) {
    now = std::min(now + kWalkStep, end);
    if (has_keys) state.keys_at = now;
    if (has_tag) state.tag_seen_at = now;
    state = advanced(std::move(state), walk.site, settings, now);
  }
  return state.walker;
}

bool can_walk(const Site& site, const WalkLimits& limits) {
  if (site.area == nullptr || std::max(limits.forward_m_per_s, limits.sideways_m_per_s) <= 0.0) return false;
  // The walk comes to rest before every edge.
  const double kept_m = 2.0 * (site.area->margin_m() + kSoftM * site.walking_scale);
  return site.area->size_m() > kept_m;
}

}  // namespace cyclorama::tour
