// SPDX-License-Identifier: Apache-2.0
/// What all kinds of walls are asked for. Each kind is a value, reentrant, in the Room frame, with the same members:
///
///   hit(ray)           where a ray first meets the lit side, or nothing
///   hit_extended(ray)   the same of the wall continued past its edges, so that nothing jumps there
///   patches(about)     the wall in about so many pieces of about the same area
///   outline()          points that bound every direction in which the wall is seen, from wherever
///   creases()          edges at which it has no tangent plane, the sharpest first
///   is_lit_from(point) whether one sees more of its lit side than of its back from there
///   can_self_shadow()    whether a part can hide another from a projector
#pragma once

#include <Eigen/Core>

#include "common/geometry/frames.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama {

/// A half-line in the room; `direction` has any length above zero.
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

/// Of a triangle as seen from a point: above 0 where its corners run counter-clockwise.
/// Source: Van Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 30, 1983.
[[nodiscard]] double solid_angle(const Eigen::Vector3d& seen_from, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& c);

}  // namespace cyclorama
