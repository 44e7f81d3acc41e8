// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "common/room/installation.h"

namespace cyclorama {

/// A direction as the panorama counts it; see common/geometry/panorama.h.
struct PanoramaDirection {
  double azimuth_rad = 0.0;
  double tan_elevation = 0.0;
};

/// Where each pixel of one projector is seen from the sweet spot, exactly, from the known geometry of the room.
/// A value; reentrant. Pixels are continuous: the centre of the first is (0.5, 0.5).
class ProjectorMap {
 public:
  /// Precondition: `projector` counts installation.projectors.
  ProjectorMap(const Installation& installation, std::size_t projector);

  [[nodiscard]] const Pinhole& lens() const { return projector_.lens; }

  /// The direction of the place that the pixel lights, on the wall or on the wall's cylinder continued without end, so
  /// that the map is smooth across the wall's edges. Azimuths never jump inside one projector's picture: they lie
  /// within half a turn of the picture's middle and may pass pi. Nothing when the pixel shines straight up or down.
  [[nodiscard]] std::optional<PanoramaDirection> direction_of(const Eigen::Vector2d& pixel) const;
  /// Where on the wall the pixel lands; nothing when it misses the wall.
  [[nodiscard]] std::optional<Point<frame::Room>> wall_point_of(const Eigen::Vector2d& pixel) const;
  /// The pixel that lights a point; nothing when the point is outside the picture.
  [[nodiscard]] std::optional<Eigen::Vector2d> pixel_lighting(const Point<frame::Room>& point) const;

 private:
  [[nodiscard]] RoomRay ray_of(const Eigen::Vector2d& pixel) const;

  CylinderWall wall_;
  CylinderWall endless_wall_;
  Point<frame::Room> eye_;
  InstalledProjector projector_;
  RigidTransform<frame::Projector, frame::Room> T_projector_room_;
  double middle_azimuth_rad_ = 0.0;
};

}  // namespace cyclorama
