// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/room/wall_parts.h"

namespace cyclorama {

/// An upright piece of a cylinder, seen from inside: the axis is vertical through (centre_x, centre_z), and the middle
/// of the arc lies towards -z (in front of the visitor). wall_parts.h describes the common members.
struct CylinderWall {
  double radius_m = 0.0;
  double arc_rad = 0.0;   ///< Whole arc, at most 2 pi.
  double bottom_m = 0.0;  ///< Height of the lower edge above the floor.
  double top_m = 0.0;
  double centre_x_m = 0.0;
  double centre_z_m = 0.0;

  [[nodiscard]] std::optional<Point<frame::Room>> hit(const RoomRay& ray) const;
  [[nodiscard]] std::optional<Point<frame::Room>> hit_extended(const RoomRay& ray) const;
  [[nodiscard]] std::vector<WallPatch> patches(std::size_t about) const;
  [[nodiscard]] std::vector<Point<frame::Room>> outline() const;
  [[nodiscard]] std::vector<WallEdge> creases() const { return {}; }
  [[nodiscard]] bool is_lit_from(const Point<frame::Room>& point) const;
  [[nodiscard]] bool can_self_shadow() const { return false; }

  /// Returns the angle along the arc from its middle, positive to the visitor's right, of a point on (or near) the
  /// wall.
  [[nodiscard]] double arc_angle_of(const Point<frame::Room>& point) const;
  [[nodiscard]] Point<frame::Room> point_at(double arc_angle, double height_m) const;
};

}  // namespace cyclorama
