// SPDX-License-Identifier: Apache-2.0
/// Who steers, and where that leads: keys, else the pattern in the visitor's hand, else the guide, else nobody.
///
/// Everything here is a function of (state, measurement, time), so that tests move the time. Time is the tour's own
/// clock when a measurement ARRIVED: a tracker's shutter times may come from another machine.
///
///       keys pressed ───────────────► kKeys     wins while pressed; each request holds for kKeysHeld
///       tag seen within kTagHeld ───► kTag      several trackers are sorted out before (wand_choice.h)
///       nobody for guide_after ─────► kGuide    never while a tag is in sight, unless it lies still very long
///       otherwise ──────────────────► kNobody   glides to rest
///
/// Where people queue, a turn is limited:
///
///       no turn ── a tag asks for something ──► turn ── turn_longest is over ──► pause (the guide leads) ──► no turn
///          ◄────────── no tag for kTurnOver ─────┘                 turn_pause, or the tag was away for a second
///
/// All four are wishes under the same limits, so a change of hands is never a jump.
#pragma once

#include <optional>

#include "kiosk/tour/navigation/body_steering.h"
#include "kiosk/tour/navigation/guide.h"
#include "kiosk/tour/navigation/tag_steering.h"
#include "kiosk/tour/navigation/walk.h"

namespace cyclorama {

enum class Steerer { kNobody, kKeys, kTag, kGuide };
[[nodiscard]] const char* to_text(Steerer steerer);

struct NavigationSettings {
  WalkLimits limits;
  TagSteeringSettings tag;
  BodySteeringSettings body;  ///< Of visitors without a pattern.
  /// Time constant of the low-pass filter on the tag's wish; the tracker has filtered the pose before.
  Duration tag_smoothing = std::chrono::milliseconds(60);
  /// Zero: no guide.
  Duration guide_after = std::chrono::seconds(45);
  /// Of one visitor, where others wait. Zero: no limit. Keys, which are the operator's, have none.
  Duration turn_longest = Duration::zero();
  /// Between two turns, so that it is felt that one is over, also when the wand changes hands in sight of the camera.
  Duration turn_pause = std::chrono::seconds(10);
};

/// As museum.proto says of Steer.
inline constexpr Duration kKeysHeld = std::chrono::milliseconds(300);
/// A tag is still held this long after it was last seen: missed pictures, and a tracker that makes only five a second,
/// must not be felt. With the longest glide (kLongestGlide) it stays below one second from lost to rest.
inline constexpr Duration kTagHeld = std::chrono::milliseconds(250);
/// Without a tag for so long, the next one is another visitor's.
inline constexpr Duration kTurnOver = std::chrono::seconds(10);
/// In a pause, a wand that was put down for so long ends it.
inline constexpr Duration kPutDown = std::chrono::seconds(1);
/// A tag that lies in sight and asks for nothing keeps the guide away this many times longer: somebody may just be
/// looking, but a tag forgotten on its stand must not silence the guide for good.
inline constexpr int kQuietTagPatience = 8;

/// A value.
struct Navigation {
  Walker walker;
  Steerer steerer = Steerer::kNobody;
  std::optional<TimePoint> advanced_at;
  std::optional<TimePoint> tag_seen_at;
  SteeringWish tag_wish;  ///< Filtered.
  std::optional<TimePoint> keys_at;
  SteeringWish keys_wish;
  std::optional<TimePoint> steered_at;  ///< When a visitor last asked for anything; at first, the start.
  std::optional<TimePoint> turn_began_at;
  std::optional<TimePoint> turn_ended_at;  ///< While it pauses.
  GuideState guide;
};

/// What is left of the visitor's turn; nothing without a limit or a turn. Below zero: the pause.
[[nodiscard]] std::optional<Duration> turn_left(const Navigation& state, const NavigationSettings& settings,
                                                TimePoint now);

[[nodiscard]] Navigation started(const Site& site);

/// A tag was seen. A time before the last one's, and a pose that is not finite, not in front of the camera or beyond
/// 50 m, are ignored. (A picture without a tag is no measurement: do not call.)
[[nodiscard]] Navigation with_tag(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                                  TimePoint arrived_at, const NavigationSettings& settings);

/// The same for a visitor who steers by the body.
[[nodiscard]] Navigation with_body(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                                   TimePoint arrived_at, const NavigationSettings& settings);

/// A request for keys; one at rest releases them at once.
[[nodiscard]] Navigation with_keys(Navigation state, const SteeringWish& wish, TimePoint arrived_at);

/// Moves on to `now`; a time before the last one moves nothing. `site` is the one given to started().
[[nodiscard]] Navigation advanced(Navigation state, const Site& site, const NavigationSettings& settings,
                                  TimePoint now);

}  // namespace cyclorama
