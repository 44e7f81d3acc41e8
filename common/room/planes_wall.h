// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common/room/wall_parts.h"

namespace cyclorama {

/// A flat piece of a wall. `right` and `up` are perpendicular and of unit length; right x up points to the lit side.
struct WallRectangle {
  Point<frame::Room> middle;
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  double width_m = 0.0;
  double height_m = 0.0;

  /// Returns the rectangle that faces a viewer who looks `pan_rad` to the right of -z and then `tilt_rad` upwards.
  static WallRectangle facing(const Point<frame::Room>& middle, double pan_rad, double tilt_rad, double width_m,
                              double height_m);
  /// Returns an upright rectangle above a line on the floor. The line runs from left to right as seen from the lit
  /// side.
  static WallRectangle above(const Eigen::Vector2d& left_xz, const Eigen::Vector2d& right_xz, double bottom_m,
                             double top_m);

  [[nodiscard]] Eigen::Vector3d normal() const { return right.cross(up); }
  /// Returns a point of the rectangle. `across` and `along` are in [-1, 1], from the left to the right and from the
  /// lower to the upper edge.
  [[nodiscard]] Point<frame::Room> point_at(double across, double along) const {
    return {middle.xyz + 0.5 * width_m * across * right + 0.5 * height_m * along * up};
  }
  [[nodiscard]] double area_m2() const { return width_m * height_m; }
};

/// One flat screen, or several that meet in corners. Beyond its edges the wall continues in the plane of the nearest
/// rectangle, so that corners continue upwards and downwards. wall_parts.h describes the common members.
struct PlanesWall {
  std::vector<WallRectangle> rectangles;

  [[nodiscard]] std::optional<Point<frame::Room>> hit(const RoomRay& ray) const;
  [[nodiscard]] std::optional<Point<frame::Room>> hit_extended(const RoomRay& ray) const;
  [[nodiscard]] std::vector<WallPatch> patches(std::size_t about) const;
  [[nodiscard]] std::vector<Point<frame::Room>> outline() const;
  /// Returns the edges of all rectangles if there are several.
  [[nodiscard]] std::vector<WallEdge> creases() const;
  [[nodiscard]] bool is_lit_from(const Point<frame::Room>& point) const;
  [[nodiscard]] bool can_self_shadow() const { return rectangles.size() > 1; }
};

}  // namespace cyclorama
