// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/navigation/navigator.h"

#include <cmath>
#include <utility>

#include "common/geometry/panorama.h"
#include "common/language/marked_texts.h"

namespace cyclorama::tour {
namespace {

constexpr double kMaxTagDistanceM = 50.0;
constexpr double kMinCommand = 1e-3;
constexpr double kArrivedRad = 0.01;  // A visitor who is led has arrived when this is left to turn.

bool held(const std::optional<TimePoint>& since, Duration how_long, TimePoint now) {
  return since && now - *since <= how_long;
}

/// Sets commands below a thousandth of the limit to zero: the filter's tail would otherwise keep the view creeping.
double settled(double command) { return std::abs(command) < kMinCommand ? 0.0 : command; }

/// Begins and ends the turns of visitors.
void keep_turns(Navigation* state, const NavigationSettings& settings, TimePoint now) {
  if (state->turn_ended_at) {
    const bool put_down = !held(state->tag_seen_at, kPutDown, now);
    if (now - *state->turn_ended_at < settings.turn_pause && !put_down) return;
    state->turn_ended_at.reset();
    state->turn_began_at.reset();
  }
  if (state->turn_began_at && !held(state->tag_seen_at, kTurnOver, now)) state->turn_began_at.reset();
  if (!state->turn_began_at && held(state->tag_seen_at, kTagHeld, now) && !state->tag_command.is_rest())
    state->turn_began_at = now;
  if (settings.max_turn > Duration::zero() && state->turn_began_at && now - *state->turn_began_at > settings.max_turn)
    state->turn_ended_at = now;
}

SteeringSource steerer_at(const Navigation& state, const NavigationSettings& settings, TimePoint now) {
  if (held(state.keys_at, kKeysHeld, now) && !state.keys_command.is_rest()) return SteeringSource::kKeys;
  const bool has_guide = settings.guide_after > Duration::zero();
  if (state.turn_ended_at) return has_guide ? SteeringSource::kGuide : SteeringSource::kNobody;
  const bool tag = held(state.tag_seen_at, kTagHeld, now);
  const Duration timeout = settings.guide_after * (tag ? kQuietTagTimeoutFactor : 1);
  const bool asked = tag && !state.tag_command.is_rest();
  if (state.guide.is_led && !asked) return SteeringSource::kGuide;
  if (!asked && has_guide && state.steered_at && now - *state.steered_at > timeout) return SteeringSource::kGuide;
  return tag ? SteeringSource::kTag : SteeringSource::kNobody;
}

bool is_sane(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag) {
  const Eigen::Vector3d& position = T_camera_tag.translation();
  return position.allFinite() && T_camera_tag.rotation().coeffs().allFinite() && position.z() > 0.0 &&
         position.norm() < kMaxTagDistanceM && std::abs(T_camera_tag.rotation().norm() - 1.0) < 1e-3;
}

/// Applies the command from the tag or body in the newest picture, smoothed.
Navigation with_command(Navigation state, const SteeringCommand& seen, TimePoint arrived_at,
                        const NavigationSettings& settings) {
  if (state.tag_seen_at && arrived_at <= *state.tag_seen_at) return state;
  const bool again = !held(state.tag_seen_at, kTagHeld, arrived_at);
  const SteeringCommand before = again ? SteeringCommand{} : state.tag_command;
  const Duration since = again ? kTagHeld : arrived_at - *state.tag_seen_at;
  const double weight = settings.tag_smoothing > Duration::zero()
                            ? 1.0 - std::exp(-to_seconds(since) / to_seconds(settings.tag_smoothing))
                            : 1.0;
  const auto mixed = [weight](double from, double to) { return settled(from + weight * (to - from)); };
  state.tag_command = {mixed(before.forward, seen.forward), mixed(before.right, seen.right),
                       mixed(before.turn, seen.turn)};
  state.tag_seen_at = arrived_at;
  return state;
}

}  // namespace

const char* to_text(SteeringSource steering_source) {
  switch (steering_source) {
    case SteeringSource::kKeys:
      return translatable("keys");
    case SteeringSource::kTag:
      return translatable("tag");
    case SteeringSource::kGuide:
      return translatable("guide");
    case SteeringSource::kNobody:
      break;
  }
  return translatable("nobody");
}

std::optional<Duration> turn_left(const Navigation& state, const NavigationSettings& settings, TimePoint now) {
  if (settings.max_turn <= Duration::zero() || !state.turn_began_at) return std::nullopt;
  return *state.turn_began_at + settings.max_turn - now;
}

Navigation started(const Site& site) {
  Navigation state;
  state.walker = site.start;
  return state;
}

Navigation with_tag(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                    TimePoint arrived_at, const NavigationSettings& settings) {
  if (!is_sane(T_camera_tag)) return state;
  return with_command(std::move(state), tag_command(T_camera_tag, settings.tag), arrived_at, settings);
}

Navigation with_body(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                     TimePoint arrived_at, const NavigationSettings& settings) {
  if (!is_sane(T_camera_body)) return state;
  return with_command(std::move(state), body_command(T_camera_body, settings.body), arrived_at, settings);
}

Navigation with_keys(Navigation state, const SteeringCommand& command, TimePoint arrived_at) {
  if (state.keys_at && arrived_at < *state.keys_at) return state;
  state.keys_command = command.limited();
  state.keys_at = arrived_at;
  return state;
}

Navigation led(Navigation state, const Site& site, std::size_t stop, TimePoint now) {
  state.guide = led_to(site, state.walker, stop, now);
  state.stop = stop;
  state.steered_at = now;
  return state;
}

Navigation cut(Navigation state, const Site& site, std::size_t stop, TimePoint now) {
  state.walker = {};
  state.walker.position_m = site.stops[stop].position_m;
  state.walker.heading_rad = site.stops[stop].heading_rad;
  if (state.steering_source != SteeringSource::kGuide) state.steered_at = now;
  state.guide = {};
  state.guide.started = state.guide.dwelling = true;
  state.guide.stop = stop;
  state.guide.since = now;
  state.stop = stop;
  return state;
}

Navigation advanced(Navigation state, const Site& site, const NavigationSettings& settings, TimePoint now) {
  if (!state.steered_at) state.steered_at = now;
  if (!state.advanced_at) state.advanced_at = now;
  if (now <= *state.advanced_at) return state;
  const Duration elapsed = now - *state.advanced_at;
  state.advanced_at = now;
  keep_turns(&state, settings, now);
  state.steering_source = steerer_at(state, settings, now);
  SteeringCommand command;
  switch (state.steering_source) {
    case SteeringSource::kKeys:
      command = state.keys_command;
      break;
    case SteeringSource::kTag:
      command = state.tag_command;
      break;
    case SteeringSource::kGuide:
      command = guide_command(&state.guide, state.walker, site, settings.limits, now);
      break;
    case SteeringSource::kNobody:
      break;
  }
  if (state.steering_source != SteeringSource::kGuide) {
    state.guide = {};
    if (!command.is_rest()) state.steered_at = now;
  } else if (state.guide.dwelling) {
    state.stop = state.guide.stop;
    const double left_rad = wrapped_angle(site.stops[state.guide.stop].heading_rad - state.walker.heading_rad);
    if (state.guide.is_led && std::abs(left_rad) < kArrivedRad) state.guide = {};
  }
  command.forward *= site.pace;
  command.right *= site.pace;
  command.turn *= site.turn_pace;
  const WalkableArea* const area = site.is_held ? nullptr : site.area.get();
  state.walker = walked(state.walker, command, elapsed, settings.limits, site.walking_scale, area);
  return state;
}

}  // namespace cyclorama::tour
