// SPDX-License-Identifier: Apache-2.0
/// The surface that the picture lands on.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/base/result.h"
#include "common/geometry/frames.h"
#include "common/geometry/rigid_transform.h"

namespace cyclorama {

/// A half-line in the room; `direction` has any length above zero.
struct RoomRay {
  Point<frame::Room> origin;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
};

/// An upright piece of a cylinder, seen from inside: the axis is vertical through (centre_x, centre_z), the middle of
/// the arc lies towards -z (in front of the visitor). A value; reentrant.
struct CylinderWall {
  double radius_m = 0.0;
  double arc_rad = 0.0;     ///< Whole arc, at most 2 pi.
  double bottom_m = 0.0;    ///< Height of the lower edge above the floor.
  double top_m = 0.0;
  double centre_x_m = 0.0;
  double centre_z_m = 0.0;

  /// Where a ray first meets the inside of the wall, or nothing.
  [[nodiscard]] std::optional<Point<frame::Room>> hit(const RoomRay& ray) const;
  /// Angle along the arc from its middle, positive to the visitor's right, of a point on (or near) the wall.
  [[nodiscard]] double arc_angle_of(const Point<frame::Room>& point) const;
  [[nodiscard]] Point<frame::Room> point_at(double arc_angle, double height_m) const;
};

}  // namespace cyclorama
