// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/room/wall_parts.h"

namespace cyclorama {

/// A cap of a sphere, seen from inside. Its axis is tilted upwards from the horizon ahead (-z): by a quarter turn in a
/// planetarium, by less in a tilted dome. wall_parts.h describes the common members.
struct DomeWall {
  Point<frame::Room> centre;
  double radius_m = 0.0;
  double field_rad = 0.0;  ///< Angle from edge to edge at the centre; 2 pi is a whole sphere.
  double tilt_rad = 0.0;   ///< Angle of the axis above the horizon.

  [[nodiscard]] std::optional<Point<frame::Room>> hit(const RoomRay& ray) const;
  [[nodiscard]] std::optional<Point<frame::Room>> hit_extended(const RoomRay& ray) const;
  [[nodiscard]] std::vector<WallPatch> patches(std::size_t about) const;
  [[nodiscard]] std::vector<Point<frame::Room>> outline() const;
  [[nodiscard]] std::vector<WallEdge> creases() const { return {}; }
  [[nodiscard]] bool is_lit_from(const Point<frame::Room>& point) const;
  [[nodiscard]] bool can_self_shadow() const { return false; }

  [[nodiscard]] Eigen::Vector3d axis() const;
  /// Returns the point at an angle from the axis, in the direction `around_rad` about the axis, counted from the right.
  [[nodiscard]] Point<frame::Room> point_at(double from_axis_rad, double around_rad) const;
};

}  // namespace cyclorama
