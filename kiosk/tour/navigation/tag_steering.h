// SPDX-License-Identifier: Apache-2.0
/// From the pose of the pattern in the visitor's hand to a wish: the paper's mapping ("Interactive Method": the
/// rotation of the pattern controls the angular velocity, its horizontal offset the speed).
///
/// The visitor faces the wall, the camera stands at the wall and faces the visitor, and the printed side of the pattern
/// faces the camera. Seen from above (the camera's y points down, into the page):
///
///        ═══════════════ wall ═══════════════
///                       ▣ camera                 Camera:  x to ITS right, which is the visitor's LEFT
///           x ◄─────────┤                                 z forward, to the visitor
///                       ▼ z
///                                                Tag:     x right for who looks at the print (the camera),
///         x ◄───────────┤ ▔▔▔ pattern                     z into the tag, to the visitor
///                       ▼ z                               so held straight, tag axes equal camera axes
///                       ☺ visitor
///
///  - A camera picture shown as it is shows the visitor's right hand on the left, as a photograph does. Therefore
///    *the pattern at the visitor's right has a NEGATIVE camera x*, and `right` grows as x falls.
///  - The pattern points where its print looks: along -z of the tag, to the wall. Turned to the visitor's right by an
///  angle a
///    (clockwise seen from above), it points along (-sin a, 0, -cos a) in the camera frame, so the tag's z axis is
///    (sin a, 0, cos a) and `a = atan2(z.x, z.z)`. Clockwise from above is the same turn for camera and visitor, so
///    unlike the offset, *the yaw has no mirror in it*: a > 0 turns the view right.
///  - Tilting the pattern up or down, or turning it in its own plane, changes nothing.
#pragma once

#include "common/geometry/rigid_transform.h"
#include "kiosk/tour/navigation/walk.h"

namespace cyclorama {

/// Up to `dead` is rest, from `full` on is the whole speed; between, 3u^2 - 2u^3, which starts and ends gently.
struct GainCurve {
  double dead = 0.0;
  double full = 1.0;
  /// In [-1, 1], odd in `offset`; 0 for NaN.
  [[nodiscard]] double at(double offset) const;
};

/// Dead zones are wider than what a hand and the detector shake. The yaw's is the widest: on a flat tag at 1 m a true
/// 5 degrees can read as 2, at 2 m and 15 degrees the deviation is 10 degrees, while offsets stay within a millimetre.
struct TagSteeringSettings {
  double neutral_distance_m = 1.0;  ///< From the camera along its axis, where forward speed is zero.
  double neutral_right_m = 0.0;     ///< To the visitor's right of the camera, where sideways speed is zero.
  GainCurve yaw_rad{0.10, 0.60};
  GainCurve sideways_m{0.06, 0.35};
  GainCurve distance_m{0.08, 0.40};
};

/// Radians, positive when the pattern points to the visitor's right; 0 when it lies flat, pointing nowhere.
[[nodiscard]] double pointing_yaw(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag);

[[nodiscard]] SteeringWish tag_wish(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                                    const TagSteeringSettings& settings);

}  // namespace cyclorama
