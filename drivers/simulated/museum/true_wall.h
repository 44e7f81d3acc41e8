// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "common/base/result.h"
#include "common/room/wall.h"
#include "drivers/simulated/museum/wall_deviation.h"

namespace cyclorama::simulated {

/// A position on a wall: the part, and `across` from left to right and `along` from the lower to the upper edge, both
/// in [0, 1]. On a dome, `across` is the angle around the axis in turns, and `along` runs from the axis to the rim such
/// that equal steps have equal areas.
struct WallPosition {
  std::size_t part = 0;
  double across = 0.0;
  double along = 0.0;
};

/// The wall as it really stands: a shape of common/room, moved rigidly, with a deviation. A value; reentrant.
class TrueWall {
 public:
  struct Hit {
    Point<frame::Room> point;
    Eigen::Vector3d normal;  ///< Unit length, towards the lit side.
    WallPosition position;
  };

  /// `T_room_wall` moves the shape; identity leaves it at its nominal pose. Errors: kInvalidArgument for a mesh
  /// (describe it by a deviation), or for a deviation on several planes, which would tear at the edges.
  static Result<TrueWall> make(Wall shape, const RigidTransform<frame::Room, frame::Room>& T_room_wall,
                               WallDeviation deviation);

  /// Returns the first hit of a ray on the lit side.
  [[nodiscard]] std::optional<Hit> hit(const RoomRay& ray) const;
  /// Equivalent of is_reached() in common/room, for the shape without its deviation.
  [[nodiscard]] bool is_reached(const Hit& at, const Point<frame::Room>& source) const;

  /// Number of parts: 1, except for walls of several planes.
  [[nodiscard]] std::size_t part_count() const;
  /// Returns whether `across` is periodic.
  [[nodiscard]] bool goes_round() const { return std::holds_alternative<DomeWall>(shape_); }
  [[nodiscard]] Hit at(const WallPosition& position) const;
  /// Area of the piece of one part between two positions, in m^2: exact without a deviation, otherwise approximated at
  /// the piece's centre.
  [[nodiscard]] double area_m2(const WallPosition& low, const WallPosition& high) const;
  /// Lengths of a part across and along, measured through its centre, for an even division into cells.
  [[nodiscard]] Eigen::Vector2d size_m(std::size_t part) const;

 private:
  /// A point in the shape's own frame.
  struct Surface {
    std::size_t part = 0;
    double s_m = 0.0;
    double t_m = 0.0;
    double above_m = 0.0;  ///< Height of a point above the shape without deviation.
  };
  TrueWall(Wall shape, const RigidTransform<frame::Room, frame::Room>& T_room_wall, WallDeviation deviation);
  [[nodiscard]] Surface surface_of(const Eigen::Vector3d& point, std::size_t part) const;
  [[nodiscard]] Eigen::Vector3d point_of(const Surface& surface) const;
  [[nodiscard]] Eigen::Vector3d normal_of(const Surface& surface) const;
  [[nodiscard]] std::optional<WallPosition> place_of(const Surface& surface) const;
  [[nodiscard]] Surface surface_of(const WallPosition& position) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> meet(const RoomRay& ray, std::size_t part) const;
  [[nodiscard]] Hit made(const Surface& surface, const Eigen::Vector3d& point, const WallPosition& position) const;

  Wall shape_;
  RigidTransform<frame::Room, frame::Room> T_room_wall_;
  RigidTransform<frame::Room, frame::Room> T_wall_room_;
  WallDeviation deviation_;
  double steepest_ = 0.0;  ///< Maximum slope of the deviation.
};

}  // namespace cyclorama::simulated
