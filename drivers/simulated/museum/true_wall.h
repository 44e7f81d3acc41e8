// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "common/base/result.h"
#include "common/room/wall.h"
#include "drivers/simulated/museum/wall_deviation.h"

namespace cyclorama::simulated {

/// A place on a wall: of which piece, and where between its edges: `across` from left to right, `along` from the lower
/// to the upper edge, in [0, 1]. On a dome `across` is the angle around the axis in turns, and `along` goes from the
/// axis to the rim so that equal steps are equal areas.
struct WallPosition {
  std::size_t part = 0;
  double across = 0.0;
  double along = 0.0;
};

/// The wall as it really stands: a shape of common/room, moved as a whole, with a deviation on it. A value; reentrant.
class TrueWall {
 public:
  struct Hit {
    Point<frame::Room> point;
    Eigen::Vector3d normal;  ///< Unit length, towards the lit side.
    WallPosition position;
  };

  /// `T_room_wall` moves the shape; identity leaves it where its own numbers say.
  /// kInvalidArgument  a mesh (describe it by a deviation), or a deviation on several planes, which would tear at the edges.
  static Result<TrueWall> make(Wall shape, const RigidTransform<frame::Room, frame::Room>& T_room_wall,
                               WallDeviation deviation);

  /// Where a ray first meets the lit side.
  [[nodiscard]] std::optional<Hit> hit(const RoomRay& ray) const;
  /// As is_reached() of common/room, for the shape without its deviation.
  [[nodiscard]] bool is_reached(const Hit& at, const Point<frame::Room>& source) const;

  /// 1 but for walls of several planes.
  [[nodiscard]] std::size_t part_count() const;
  /// Whether `across` goes round and meets itself.
  [[nodiscard]] bool goes_round() const { return std::holds_alternative<DomeWall>(shape_); }
  [[nodiscard]] Hit at(const WallPosition& position) const;
  /// Of the piece between two places of one part, by its middle; metres from edge to edge, and m^2.
  [[nodiscard]] double area_m2(const WallPosition& low, const WallPosition& high) const;
  /// Middle lengths of a part, to divide it evenly: across, along.
  [[nodiscard]] Eigen::Vector2d size_m(std::size_t part) const;

 private:
  /// In the shape's own frame.
  struct Surface {
    std::size_t part = 0;
    double s_m = 0.0;
    double t_m = 0.0;
    double above_m = 0.0;  ///< Of a point, over the shape without deviation.
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
  double steepest_ = 0.0;  ///< Slope of the deviation, anywhere.
};

}  // namespace cyclorama::simulated
