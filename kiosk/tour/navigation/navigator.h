// SPDX-License-Identifier: Apache-2.0
/// Decides who steers, and moves the visitor accordingly: the keys, otherwise the visitor's tag, otherwise the guide,
/// otherwise nobody.
///
/// Everything here is a function of (state, measurement, time), so that tests control the time. The time of a
/// measurement is that of its ARRIVAL on the tour's clock, since a tracker's shutter times may come from another
/// machine.
///
///       keys pressed ───────────────► kKeys     wins while pressed; each request holds for kKeysHeld
///       led to a stop on request ───► kGuide    until it is reached, or keys or a tag steer
///       tag seen within kTagHeld ───► kTag      wand_choice.h has chosen between several trackers before
///       nobody for guide_after ─────► kGuide    never while a tag is in sight, unless it lies still very long
///       otherwise ──────────────────► kNobody   glides to rest
///
/// Where visitors queue, a turn is limited:
///
///       no turn ── a tag steers ──► turn ── max_turn is over ──► pause (the guide leads) ──► no turn
///          ◄── no tag for kTurnOver ──┘           ended by turn_pause, or by a tag that is away for a second
///
/// The commands of all sources are subject to the same limits, so that a change of control is never a jump.
#pragma once

#include <optional>

#include "kiosk/tour/navigation/body_steering.h"
#include "kiosk/tour/navigation/guide.h"
#include "kiosk/tour/navigation/tag_steering.h"
#include "kiosk/tour/navigation/walk.h"

namespace cyclorama::tour {

enum class SteeringSource { kNobody, kKeys, kTag, kGuide };
[[nodiscard]] const char* to_text(SteeringSource steering_source);

struct NavigationSettings {
  WalkLimits limits;
  TagSteeringSettings tag;
  BodySteeringSettings body;  ///< Settings for visitors without a tag.
  /// Time constant of the low-pass filter on the tag's command; the tracker has filtered the pose before.
  Duration tag_smoothing = std::chrono::milliseconds(60);
  /// Time without steering after which the guide leads; zero: never.
  Duration guide_after = std::chrono::seconds(45);
  /// Limit of one visitor's turn where others wait; zero: no limit. The keys are the operator's and are not limited.
  Duration max_turn = Duration::zero();
  /// Pause between two turns, so that visitors notice the end of a turn even when the wand changes hands in sight of
  /// the camera.
  Duration turn_pause = std::chrono::seconds(10);
};

/// Time for which a request of the keys holds, as museum.proto defines for Steer.
inline constexpr Duration kKeysHeld = std::chrono::milliseconds(300);
/// A tag counts as held for this long after it was last seen, so that missed pictures, or a tracker with only five
/// pictures a second, are not felt. Together with kMaxGlide, the time from losing the tag to rest stays below one
/// second.
inline constexpr Duration kTagHeld = std::chrono::milliseconds(250);
/// After this long without a tag, the next tag belongs to another visitor.
inline constexpr Duration kTurnOver = std::chrono::seconds(10);
/// During a pause, a wand that was put down for this long ends the pause.
inline constexpr Duration kPutDown = std::chrono::seconds(1);
/// A tag that is in sight but at rest delays the guide by this factor: somebody may just be looking, but a tag
/// forgotten on its stand must not stop the guide for good.
inline constexpr int kQuietTagTimeoutFactor = 8;

/// State of the visitor and of the steering sources. A value.
struct Navigation {
  Walker walker;
  SteeringSource steering_source = SteeringSource::kNobody;
  std::optional<TimePoint> advanced_at;
  std::optional<TimePoint> tag_seen_at;
  SteeringCommand tag_command;  ///< Filtered.
  std::optional<TimePoint> keys_at;
  SteeringCommand keys_command;
  std::optional<TimePoint> steered_at;  ///< Last time at which a visitor steered; initially the start.
  std::optional<TimePoint> turn_began_at;
  std::optional<TimePoint> turn_ended_at;  ///< Set during a pause.
  GuideState guide;
  std::optional<std::size_t> stop;  ///< Stop that was reached last, or that the visitor is led to.
};

/// Returns the time left in the visitor's turn; nothing without a limit or a turn. Negative during the pause.
[[nodiscard]] std::optional<Duration> turn_left(const Navigation& state, const NavigationSettings& settings,
                                                TimePoint now);

[[nodiscard]] Navigation started(const Site& site);

/// Applies a tag that was seen. Ignores a time before the last one, and a pose that is not finite, not in front of the
/// camera or beyond 50 m. Must not be called for a picture without a tag.
[[nodiscard]] Navigation with_tag(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                                  TimePoint arrived_at, const NavigationSettings& settings);

/// Applies the pose of a visitor who steers by the body; otherwise like with_tag().
[[nodiscard]] Navigation with_body(Navigation state, const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                                   TimePoint arrived_at, const NavigationSettings& settings);

/// Applies a request from the keys; a request to rest releases the keys at once.
[[nodiscard]] Navigation with_keys(Navigation state, const SteeringCommand& command, TimePoint arrived_at);

/// Leads the visitor to a stop on request. Preconditions as for led_to() in guide.h.
[[nodiscard]] Navigation led(Navigation state, const Site& site, std::size_t stop, TimePoint now);

/// Puts the visitor at a stop, at rest. Precondition: site.area is set, stop < site.stops.size().
[[nodiscard]] Navigation cut(Navigation state, const Site& site, std::size_t stop, TimePoint now);

/// Advances to `now`; a time before the last one changes nothing. `site` must be the site that was passed to started().
[[nodiscard]] Navigation advanced(Navigation state, const Site& site, const NavigationSettings& settings,
                                  TimePoint now);

}  // namespace cyclorama::tour
