// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/picture_place.h"
#include "common/room/installation.h"

namespace cyclorama::warp {

/// A direction in the panorama's coordinates (common/geometry/panorama.h), or, for pictures of other shapes, the
/// coordinates of a PicturePlace.
struct PanoramaDirection {
  double azimuth_rad = 0.0;
  double tan_elevation = 0.0;
};

/// Returns `position`; its azimuth, if the picture has one, is shifted by whole turns to within half a turn of
/// `middle_rad`, because azimuths must not jump within one projector's picture.
[[nodiscard]] PicturePlace counted_near(const PicturePlace& position, const PictureShape& picture, double middle_rad);

/// Maps each pixel of one projector to its direction from the sweet spot, computed exactly from the known geometry of
/// the room. A value; reentrant. Pixels are continuous: the centre of the first pixel is (0.5, 0.5).
class ProjectorMap {
 public:
  /// Precondition: `projector` is an index into installation.projectors.
  ProjectorMap(const Installation& installation, std::size_t projector);

  [[nodiscard]] const Pinhole& lens() const { return projector_.lens; }
  /// Returns the lines in the projector's picture along which the map has a kink, those of the wall's sharpest creases
  /// first; the wall's edges inside the picture are among them.
  [[nodiscard]] std::vector<Eigen::Hyperplane<double, 2>> creases() const;

  /// Returns the direction, not normalised, in which the eye sees the pixel on the wall or on the wall's continuation
  /// beyond its edges, so that the map is smooth there. Empty if the pixel meets neither.
  [[nodiscard]] std::optional<Eigen::Vector3d> view_direction_of(const Eigen::Vector2d& pixel) const;
  /// Returns the pixel's position in a picture. Azimuths never jump within one projector's picture: they lie within
  /// half a turn of the picture's middle and may exceed pi. Empty if view_direction_of() is, or if the picture has no
  /// position for that direction.
  [[nodiscard]] std::optional<PicturePlace> place_of(const Eigen::Vector2d& pixel, const PictureShape& picture) const;
  /// Returns the pixel's position in a panorama. See place_of().
  [[nodiscard]] std::optional<PanoramaDirection> direction_of(const Eigen::Vector2d& pixel) const;
  /// Returns the point of the wall that the pixel lights; empty if it misses the wall.
  [[nodiscard]] std::optional<Point<frame::Room>> wall_point_of(const Eigen::Vector2d& pixel) const;
  /// Returns the pixel that lights a point of the wall; empty if the point is outside the picture, in the shadow of
  /// another part of the wall, or seen from behind.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_lighting(const Point<frame::Room>& point) const;

 private:
  [[nodiscard]] RoomRay ray_of(const Eigen::Vector2d& pixel) const;

  Wall wall_;
  Point<frame::Room> eye_;
  InstalledProjector projector_;
  RigidTransform<frame::Projector, frame::Room> T_projector_room_;
  double middle_azimuth_rad_ = 0.0;
};

}  // namespace cyclorama::warp
