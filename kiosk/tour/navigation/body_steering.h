// SPDX-License-Identifier: Apache-2.0
/// From how a visitor without a pattern stands to a wish: leaning turns, stepping sideways slides, coming nearer walks.
///
///        ═══════════════ wall ═══════════════
///                       ▣ camera                 The pose is that of a "tag" worn on the body: its place is where the
///             back  ◄── + ──► forward            visitor stands, and its turn about the camera's z is the lean. The
///                       ☺ mark on the floor      visitor's right is the camera's -x, as in tag_steering.h; leaning to
///                                                the right is a turn against the clock in the picture.
#pragma once

#include "kiosk/tour/navigation/tag_steering.h"

namespace cyclorama {

/// Dead zones are as wide as people sway and fidget while they look; wider than a hand's.
struct BodySteeringSettings {
  double stand_m = 2.0;  ///< From the camera to the mark, where forward speed is zero; the tracker has the same.
  double neutral_right_m = 0.0;
  GainCurve lean_rad{0.10, 0.32};
  GainCurve sideways_m{0.14, 0.45};
  GainCurve distance_m{0.16, 0.50};
};

/// Radians, positive to the visitor's right.
[[nodiscard]] double lean_of(const RigidTransform<frame::Camera, frame::Tag>& T_camera_body);

[[nodiscard]] SteeringWish body_wish(const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                                     const BodySteeringSettings& settings);

}  // namespace cyclorama
