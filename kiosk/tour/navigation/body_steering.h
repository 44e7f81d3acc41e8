// SPDX-License-Identifier: Apache-2.0
/// Maps the pose of a visitor without a tag to a steering command: leaning turns the view, a step sideways moves
/// sideways, and a step towards the wall moves forward.
///
///        ═══════════════ wall ═══════════════
///                       ▣ camera                 The pose is that of a "tag" worn on the body: its position is where
///             back  ◄── + ──► forward            the visitor stands; its rotation about the camera's z is the lean.
///                       ☺ mark on the floor      The visitor's right is the camera's -x, as in tag_steering.h; leaning
///                                                to the right is an anticlockwise rotation in the picture.
#pragma once

#include "kiosk/tour/navigation/tag_steering.h"

namespace cyclorama::tour {

/// The dead zones cover how much people sway and fidget while they look; they are wider than the dead zones for a hand.
struct BodySteeringSettings {
  /// Distance from the camera to the mark, where the forward speed is zero; must equal the tracker's setting.
  double mark_distance_m = 2.0;
  double neutral_right_m = 0.0;
  GainCurve lean_rad{0.10, 0.32};
  GainCurve sideways_m{0.14, 0.45};
  GainCurve distance_m{0.16, 0.50};
};

/// Returns the lean in radians, positive to the visitor's right; 0 for a body that is nearly horizontal.
[[nodiscard]] double lean_of(const RigidTransform<frame::Camera, frame::Tag>& T_camera_body);

[[nodiscard]] SteeringCommand body_command(const RigidTransform<frame::Camera, frame::Tag>& T_camera_body,
                                           const BodySteeringSettings& settings);

}  // namespace cyclorama::tour
