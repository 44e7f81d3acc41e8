// SPDX-License-Identifier: Apache-2.0
/// Maps the pose of the visitor's tag to a steering command: the tag's rotation controls the angular velocity, its
/// horizontal offset the speed. Source: "Immersive Virtual Tour using Multi-projection with Remote Cluster Rendering",
/// section "Interactive Method".
///
/// The visitor faces the wall, the camera stands at the wall and faces the visitor, and the printed side of the tag
/// faces the camera. Seen from above (the camera's y points down, into the page):
///
///        ═══════════════ wall ═══════════════
///                       ▣ camera                 Camera:  x to ITS right, which is the visitor's LEFT
///           x ◄─────────┤                                 z forward, to the visitor
///                       ▼ z
///                                                Tag:     x right as seen by the camera, which looks at the print
///         x ◄───────────┤ ▔▔▔ tag                         z into the tag, to the visitor
///                       ▼ z                               so a tag held straight has the camera's axes
///                       ☺ visitor
///
///  - An unmirrored camera picture shows the visitor's right hand on the left, as a photograph does. Therefore *a tag
///    at the visitor's right has a NEGATIVE camera x*, and `right` grows as x falls.
///  - The tag points along the normal of its print: along -z of the tag, to the wall. Turned to the visitor's right by
///    an angle a (clockwise seen from above), it points along (-sin a, 0, -cos a) in the camera frame, so the tag's z
///    axis is (sin a, 0, cos a) and `a = atan2(z.x, z.z)`. Clockwise from above is the same rotation for camera and
///    visitor, so unlike the offset, *the yaw is not mirrored*: a > 0 turns the view right.
///  - Tilting the tag up or down, or rotating it in its own plane, changes nothing.
#pragma once

#include "common/geometry/rigid_transform.h"
#include "kiosk/tour/navigation/walk.h"

namespace cyclorama::tour {

/// Response curve: 0 up to `dead`, 1 from `full` on; between them 3u^2 - 2u^3, which starts and ends gently.
struct GainCurve {
  double dead = 0.0;
  double full = 1.0;
  /// Returns a value in [-1, 1], odd in `offset`; 0 for NaN.
  [[nodiscard]] double at(double offset) const;
};

/// The dead zones exceed the noise of the hand and of the detector. The yaw has the widest: for a flat tag at 1 m, a
/// true yaw of 5 degrees can be measured as 2, and at 2 m a yaw of 15 degrees can be off by 10, whereas offsets are
/// accurate to a millimetre.
struct TagSteeringSettings {
  double neutral_distance_m = 1.0;  ///< Distance from the camera along its axis at which the forward speed is zero.
  double neutral_right_m = 0.0;  ///< Offset to the visitor's right of the camera at which the sideways speed is zero.
  GainCurve yaw_rad{0.10, 0.60};
  GainCurve sideways_m{0.06, 0.35};
  GainCurve distance_m{0.08, 0.40};
};

/// Returns radians, positive when the tag points to the visitor's right; 0 when it lies flat and points nowhere.
[[nodiscard]] double pointing_yaw(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag);

[[nodiscard]] SteeringCommand tag_command(const RigidTransform<frame::Camera, frame::Tag>& T_camera_tag,
                                          const TagSteeringSettings& settings);

}  // namespace cyclorama::tour
