// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/navigator.h"

#include <cmath>
#include <utility>

namespace cyclorama {
namespace {

constexpr double kFarthestTagM = 50.0;
constexpr double kLeastWish = 1e-3;

bool held(const std::optional<TimePoint>& since, Duration how_long, TimePoint now) {
  return since && now - *since <= how_long;
}

/// Sets commands below a thousandth of the limit to zero: the filter's tail would otherwise keep the view creeping.
double settled(double wish) { return std::abs(wish) < kLeastWish ? 0.0 : wish; }

/// Begins and ends the turns of visitors.
void keep_turns(Navigation* state, const NavigationSettings& settings, TimePoint now) {
  if (state->turn_ended_at) {
    const bool put_down = !held(state->tag_seen_at, kPutDown, now);
    if (now - *state->turn_ended_at < settings.turn_pause && !put_down) return;
    state->turn_ended_at.reset();
    state->turn_began_at.reset();
  }
  if (state->turn_began_at && !held(state->tag_seen_at, kTurnOver, now)) state->turn_began_at.reset();
  if (!state->turn_began_at && held(state->tag_seen_at, kTagHeld, now) && !state->tag_wish.is_rest())
    state->turn_began_at = now;
  if (settings.turn_longest > Duration::zero() && state->turn_began_at &&
      now - *state->turn_began_at > settings.turn_longest)
    state->turn_ended_at = now;
}

Steerer steerer_at(const Navigation& state, const NavigationSettings& settings, TimePoint now) {
  if (held(state.keys_at, kKeysHeld, now) && !state.keys_wish.is_rest()) return Steerer::kKeys;
  const bool has_guide = settings.guide_after > Duration::zero();
  if (state.turn_ended_at) return has_guide ? Steerer::kGuide : Steerer::kNobody;
  const bool tag = held(state.tag_seen_at, kTagHeld, now);
  const Duration patience = settings.guide_after * (tag ? kQuietTagPatience : 1);
  const bool asked = tag && !state.tag_wish.is_rest();
  if (!asked && has_guide && state.steered_at && now - *state.steered_at > patience) return Steerer::kGuide;
  return tag ? Steerer::kTag : Steerer::kNobody;
}

bool is_sane(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag) {
  const Eigen::Vector3d& place = T_camera_tag.translation();
  return place.allFinite() && T_camera_tag.rotation().coeffs().allFinite() && place.z() > 0.0 &&
         place.norm() < kFarthestTagM && std::abs(T_camera_tag.rotation().norm() - 1.0) < 1e-3;
}

/// Applies the command from the tag or body in the newest picture, smoothed.
Navigation with_wish(Navigation state, const SteeringWish& seen, TimePoint arrived_at,
                     const NavigationSettings& settings) {
  if (state.tag_seen_at && arrived_at <= *state.tag_seen_at) return state;
  const bool again = !held(state.tag_seen_at, kTagHeld, arrived_at);
  const SteeringWish before = again ? SteeringWish{} : state.tag_wish;
  const Duration since = again ? kTagHeld : arrived_at - *state.tag_seen_at;
  const double weight = settings.tag_smoothing > Duration::zero()
                            ? 1.0 - std::exp(-to_seconds(since) / to_seconds(settings.tag_smoothing))
                            : 1.0;
  const auto mixed = [weight](double from, double to) { return settled(from + weight * (to - from)); };
  state.tag_wish = {mixed(before.forward, seen.forward), mixed(before.right, seen.right),
                    mixed(before.turn, seen.turn)};
  state.tag_seen_at = arrived_at;
  return state;
}

}  // namespace

const char* to_text(Steerer steerer) {
  switch (steerer) {
    case Steerer::kKeys:
      return "keys";
    case Steerer::kTag:
      return "tag";
    case Steerer::kGuide:
      return "guide";
    case Steerer::kNobody:
      break;
  }
  return "nobody";
}

std::optional<Duration> turn_left(const Navigation& state, const NavigationSettings& settings, TimePoint now) {
  if (settings.turn_longest <= Duration::zero() || !state.turn_began_at) return std::nullopt;
  return *state.turn_began_at + settings.turn_longest - now;
}

Navigation started(const Site& site) {
  Navigation state;
  state.walker = site.start;
  return state;
}

Navigation with_tag(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                    TimePoint arrived_at, const NavigationSettings& settings) {
  if (!is_sane(T_camera_tag)) return state;
  return with_wish(std::move(state), tag_wish(T_camera_tag, settings.tag), arrived_at, settings);
}

Navigation with_body(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                     TimePoint arrived_at, const NavigationSettings& settings) {
  if (!is_sane(T_camera_body)) return state;
  return with_wish(std::move(state), body_wish(T_camera_body, settings.body), arrived_at, settings);
}

Navigation with_keys(Navigation state, const SteeringWish& wish, TimePoint arrived_at) {
  if (state.keys_at && arrived_at < *state.keys_at) return state;
  state.keys_wish = wish.limited();
  state.keys_at = arrived_at;
  return state;
}

Navigation advanced(Navigation state, const Site& site, const NavigationSettings& settings, TimePoint now) {
  if (!state.steered_at) state.steered_at = now;
  if (!state.advanced_at) state.advanced_at = now;
  if (now <= *state.advanced_at) return state;
  const Duration elapsed = now - *state.advanced_at;
  state.advanced_at = now;
  keep_turns(&state, settings, now);
  state.steerer = steerer_at(state, settings, now);
  SteeringWish wish;
  switch (state.steerer) {
    case Steerer::kKeys:
      wish = state.keys_wish;
      break;
    case Steerer::kTag:
      wish = state.tag_wish;
      break;
    case Steerer::kGuide:
      wish = guide_wish(&state.guide, state.walker, site, settings.limits, now);
      break;
    case Steerer::kNobody:
      break;
  }
  if (state.steerer != Steerer::kGuide) {
    state.guide = {};
    if (!wish.is_rest()) state.steered_at = now;
  }
  state.walker = walked(state.walker, wish, elapsed, settings.limits, site.walking_scale, site.area.get());
  return state;
}

}  // namespace cyclorama
