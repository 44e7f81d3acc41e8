// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "common/geometry/picture_place.h"
#include "common/room/installation.h"

namespace cyclorama::warp {

/// A direction as the panorama counts it; see common/geometry/panorama.h. Of pictures of other shapes a PicturePlace.
struct PanoramaDirection {
  double azimuth_rad = 0.0;
  double tan_elevation = 0.0;
};

/// The same place, with its azimuth, where the picture has any, within half a turn of `middle_rad`: azimuths of one
/// projector's picture must not jump.
[[nodiscard]] PicturePlace counted_near(const PicturePlace& position, const PictureShape& picture, double middle_rad);

/// Where each pixel of one projector is seen from the sweet spot, exactly, from the known geometry of the room.
/// A value; reentrant. Pixels are continuous: the centre of the first is (0.5, 0.5).
class ProjectorMap {
 public:
  /// Precondition: `projector` counts installation.projectors.
  ProjectorMap(const Installation& installation, std::size_t projector);

  [[nodiscard]] const Pinhole& lens() const { return projector_.lens; }
  /// Lines in the projector's picture along which the map has a kink, by the wall's sharpest creases first: where an edge
  /// of the wall lies inside of the picture.
  [[nodiscard]] std::vector<Eigen::Hyperplane<double, 2>> creases() const;

  /// What the eye sees where the pixel lands, on the wall or on the wall continued past its edges, so that the map is
  /// smooth there; not normalised. Nothing when the pixel meets neither.
  [[nodiscard]] std::optional<Eigen::Vector3d> view_direction_of(const Eigen::Vector2d& pixel) const;
  /// Where that lies in a picture. Azimuths never jump inside one projector's picture: they lie within half a turn of
  /// the picture's middle and may pass pi. Nothing also where the picture has no place for the direction.
  [[nodiscard]] std::optional<PicturePlace> place_of(const Eigen::Vector2d& pixel, const PictureShape& picture) const;
  /// The same in a panorama.
  [[nodiscard]] std::optional<PanoramaDirection> direction_of(const Eigen::Vector2d& pixel) const;
  /// Where on the wall the pixel lands; nothing when it misses the wall.
  [[nodiscard]] std::optional<Point<frame::Room>> wall_point_of(const Eigen::Vector2d& pixel) const;
  /// The pixel that lights a point of the wall; nothing when the point is outside the picture, in the shade of another
  /// part of the wall, or seen from behind.
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
