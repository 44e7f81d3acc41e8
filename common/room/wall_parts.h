// SPDX-License-Identifier: Apache-2.0
/// Members that all kinds of walls have in common. Each kind is a value, reentrant, in the Room frame:
///
///   hit(ray)            first point at which a ray meets the lit side, or nothing
///   hit_extended(ray)   same for the wall continued beyond its edges, so that nothing jumps there
///   patches(about)      the wall in about that many pieces of about the same area
///   outline()           points that bound all directions in which the wall is seen, from any position
///   creases()           edges at which the wall has no tangent plane, the sharpest first
///   is_lit_from(point)  true if more of the wall's lit side than of its back is visible from the point
///   can_self_shadow()   true if a part of the wall can hide another part from a projector
#pragma once

#include <Eigen/Core>

#include "common/geometry/frames.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama {

/// A half-line in the room; `direction` has any length other than zero.
struct RoomRay {
  Point<frame::Room> origin;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
};

struct WallPatch {
  Point<frame::Room> middle;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Unit length, towards the lit side.
  double area_m2 = 0.0;
};

struct WallEdge {
  Point<frame::Room> from;
  Point<frame::Room> to;
};

/// Returns the solid angle of a triangle as seen from a point; positive if its corners run counter-clockwise.
/// Source: Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30, 1983.
[[nodiscard]] double solid_angle(const Eigen::Vector3d& seen_from, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c);

}  // namespace cyclorama
