// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/guide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "common/geometry/panorama.h"

namespace cyclorama::tour {
namespace {

using Eigen::Vector2d;

constexpr double kPace = 0.6;               // Fraction of the speed limit: a stroll.
constexpr double kTurnPace = 0.45;          // Fraction of the turn limit.
constexpr double kSlowDownPerSecond = 0.9;  // Speed per remaining metre, for a soft arrival.
// Distance at which a position on the path counts as passed, in the visitor's metres.
constexpr double kPassedM = 0.25;
constexpr double kArrivedM = 0.05;
// Distance that counts as arrived after kAlmost: braking (brake.h) keeps a stop beside a wall out of reach.
constexpr double kAlmostM = 0.15;
constexpr auto kAlmost = std::chrono::milliseconds(500);
constexpr double kGlanceRad = 0.14;
constexpr double kGlanceS = 8.0;  // Duration of a glance to both sides.
constexpr double kLookAroundRadPerSecond = 0.10;
// With more corners than this, the guide walks straight to the stop. The search takes a few milliseconds per stop.
constexpr std::size_t kMaxPathCorners = 128;
constexpr double kAtStopM = 0.6;  // Distance in the visitor's metres within which a visitor is at a stop.
constexpr auto kStuckTimeout = std::chrono::seconds(4);

double part(double wanted, double limit) { return limit > 0.0 ? std::clamp(wanted / limit, -1.0, 1.0) : 0.0; }

double turn_command(const Walker& walker, double heading_rad, const WalkLimits& limits) {
  const double left = wrapped_angle(heading_rad - walker.heading_rad);
  return std::clamp(part(kSlowDownPerSecond * left, limits.turn_rad_per_s), -kTurnPace, kTurnPace);
}

/// Returns the way between the stops; null if none is given.
const GuideWay* way_between(const Site& site, std::size_t from, std::size_t to) {
  const auto way = std::find_if(site.ways.begin(), site.ways.end(), [&](const GuideWay& w) {
    return (w.from == from && w.to == to) || (w.from == to && w.to == from);
  });
  return way == site.ways.end() ? nullptr : &*way;
}

/// Returns the positions to pass from the visitor's to the stop.
std::vector<Vector2d> path_to(const Site& site, const Walker& walker, std::size_t stop) {
  std::vector<Vector2d> goals;
  const std::optional<std::size_t> here = stop_at(site, walker);
  if (const GuideWay* const way = here ? way_between(site, *here, stop) : nullptr) {
    goals = way->through;
    if (way->to != stop) std::reverse(goals.begin(), goals.end());
  }
  goals.push_back(site.stops[stop].position_m);
  std::vector<Vector2d> path;
  Vector2d from = walker.position_m;
  for (const Vector2d& goal : goals) {
    const std::vector<Vector2d> part = shortest_path(*site.area, from, goal);
    path.insert(path.end(), part.begin(), part.end());
    from = goal;
  }
  return path;
}

void set_out(GuideState* state, std::size_t stop, const Walker& walker, const Site& site, TimePoint now) {
  state->started = true;
  state->stop = stop;
  state->dwelling = false;
  state->since = state->nearer_at = now;
  state->nearest_m = std::numeric_limits<double>::infinity();
  state->path = path_to(site, walker, stop);
}

/// Returns the stop at which the guide's round has to continue now; nothing while it is on its way or stays.
std::optional<std::size_t> due_stop(const GuideState& state, const Walker& walker, const Site& site, TimePoint now) {
  if (!state.started) return nearest_stop(site, walker);
  if (!state.dwelling || state.is_led || now - state.since < site.stops[state.stop].stay) return std::nullopt;
  return (state.stop + 1) % site.stops.size();
}

SteeringCommand dwell(const GuideState& state, const Walker& walker, const GuideStop& stop, const WalkLimits& limits,
                      TimePoint now) {
  const double turns = to_seconds(now - state.since) / kGlanceS;
  const double glance = state.is_led ? 0.0 : kGlanceRad * std::sin(2.0 * std::numbers::pi * turns);
  return {0.0, 0.0, turn_command(walker, stop.heading_rad + glance, limits)};
}

SteeringCommand stroll(const GuideState& state, const Walker& walker, const GuideStop& stop, double scale,
                       const WalkLimits& limits) {
  const Vector2d to = (state.path.front() - walker.position_m) / scale;  // In the visitor's metres.
  const double left_m = to.norm();
  const bool last = state.path.size() == 1;
  const double max = kPace * std::min(limits.forward_m_per_s, limits.sideways_m_per_s);
  const double speed = last ? std::min(max, kSlowDownPerSecond * left_m) : max;
  const Vector2d velocity = left_m > 0.0 ? Vector2d(to * (speed / left_m)) : Vector2d::Zero();
  const double heading = last && left_m < 1.0 ? stop.heading_rad : std::atan2(to.x(), -to.y());
  return {part(velocity.dot(forward_of(walker.heading_rad)), limits.forward_m_per_s),
          part(velocity.dot(right_of(walker.heading_rad)), limits.sideways_m_per_s),
          turn_command(walker, heading, limits)};
}

}  // namespace

SteeringCommand guide_command(GuideState* state, const Walker& walker, const Site& site, const WalkLimits& limits,
                              TimePoint now) {
  if (site.area == nullptr || site.stops.empty())
    return {0.0, 0.0, part(kLookAroundRadPerSecond, limits.turn_rad_per_s)};
  if (const auto due = due_stop(*state, walker, site, now)) {
    if (!needs_cut(site, walker, *due)) {
      set_out(state, *due, walker, site, now);
    } else if (!state->started) {
      return {};
    }
  }
  const std::size_t next_stop = (state->stop + 1) % site.stops.size();
  const GuideStop& stop = site.stops[state->stop];
  if (state->dwelling) return dwell(*state, walker, stop, limits, now);

  const double left_m = (state->path.front() - walker.position_m).norm() / site.walking_scale;
  const bool last = state->path.size() == 1;
  const bool almost = last && left_m < kAlmostM && now - state->nearer_at > kAlmost;
  if (almost || left_m < (last ? kArrivedM : kPassedM)) {
    state->nearest_m = std::numeric_limits<double>::infinity();
    if (last) {
      state->dwelling = true;
      state->since = now;
      return dwell(*state, walker, stop, limits, now);
    }
    state->path.erase(state->path.begin());
  } else if (left_m < state->nearest_m - 0.01) {
    state->nearest_m = left_m;
    state->nearer_at = now;
  } else if (now - state->nearer_at > kStuckTimeout) {
    if (std::exchange(state->is_led, false) || needs_cut(site, walker, next_stop)) return {};
    set_out(state, next_stop, walker, site, now);
  }
  return stroll(*state, walker, site.stops[state->stop], site.walking_scale, limits);
}

std::optional<std::size_t> guide_cut(const GuideState& state, const Walker& walker, const Site& site, TimePoint now) {
  if (site.area == nullptr || site.stops.empty()) return std::nullopt;
  const std::optional<std::size_t> due = due_stop(state, walker, site, now);
  return due && needs_cut(site, walker, *due) ? due : std::nullopt;
}

bool needs_cut(const Site& site, const Walker& walker, std::size_t stop) {
  const std::optional<std::size_t> here = stop_at(site, walker);
  if (here == stop) return false;
  if (site.reduced_motion || site.is_held) return true;
  const GuideWay* const way = here ? way_between(site, *here, stop) : nullptr;
  return way != nullptr && way->is_cut;
}

GuideState led_to(const Site& site, const Walker& walker, std::size_t stop, TimePoint now) {
  GuideState state;
  set_out(&state, stop, walker, site, now);
  state.is_led = true;
  return state;
}

std::size_t nearest_stop(const Site& site, const Walker& walker) {
  const auto nearer = [&](const GuideStop& a, const GuideStop& b) {
    return (a.position_m - walker.position_m).norm() < (b.position_m - walker.position_m).norm();
  };
  return static_cast<std::size_t>(std::min_element(site.stops.begin(), site.stops.end(), nearer) - site.stops.begin());
}

std::optional<std::size_t> stop_at(const Site& site, const Walker& walker) {
  if (site.stops.empty()) return std::nullopt;
  const std::size_t nearest = nearest_stop(site, walker);
  const double away_m = (site.stops[nearest].position_m - walker.position_m).norm() / site.walking_scale;
  return away_m <= kAtStopM ? std::optional(nearest) : std::nullopt;
}

std::vector<Vector2d> shortest_path(const WalkableArea& area, const Vector2d& from, const Vector2d& to) {
  if (area.sees(from, to) || area.corners().size() > kMaxPathCorners) return {to};
  // Dijkstra over the two ends and a position beside every corner. Corners that do not project into the area are never
  // on a shortest path, so they need not be removed.
  std::vector<Vector2d> positions{from, to};
  for (const Vector2d& corner : area.corners()) positions.push_back(area.nearest_allowed(corner));
  std::vector<double> lengths(positions.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> previous(positions.size(), 0);
  std::vector<bool> settled(positions.size(), false);
  lengths[0] = 0.0;
  for (std::size_t round = 0; round < positions.size(); ++round) {
    std::size_t here = positions.size();
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (!settled[i] && std::isfinite(lengths[i]) && (here == positions.size() || lengths[i] < lengths[here]))
        here = i;
    }
    if (here == positions.size() || here == 1) break;
    settled[here] = true;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double length = lengths[here] + (positions[i] - positions[here]).norm();
      if (settled[i] || length >= lengths[i] || !area.sees(positions[here], positions[i])) continue;
      lengths[i] = length;
      previous[i] = here;
    }
  }
  if (!std::isfinite(lengths[1])) return {to};
  std::vector<Vector2d> path{to};
  for (std::size_t at = previous[1]; at != 0; at = previous[at]) path.insert(path.begin(), positions[at]);
  return path;
}

}  // namespace cyclorama::tour
