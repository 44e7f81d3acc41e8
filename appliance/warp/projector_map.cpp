// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/projector_map.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace cyclorama {

ProjectorMap::ProjectorMap(const Installation& installation, std::size_t projector)
    : wall_(installation.wall), endless_wall_(installation.wall), eye_(installation.sweet_spot) {
  CHECK(projector < installation.projectors.size());
  projector_ = installation.projectors[projector];
  T_projector_room_ = projector_.T_room_projector.inverse();
  endless_wall_.bottom_m = -std::numeric_limits<double>::infinity();
  endless_wall_.top_m = std::numeric_limits<double>::infinity();
  endless_wall_.arc_rad = 4.0 * std::numbers::pi;
  const auto middle = direction_of({0.5 * lens().width_px, 0.5 * lens().height_px});
  if (middle) middle_azimuth_rad_ = middle->azimuth_rad;
}

RoomRay ProjectorMap::ray_of(const Eigen::Vector2d& pixel) const {
  return {{projector_.T_room_projector.translation()},
          projector_.T_room_projector.rotation() * lens().direction_at(pixel.x(), pixel.y())};
}

std::optional<PanoramaDirection> ProjectorMap::direction_of(const Eigen::Vector2d& pixel) const {
  const auto point = endless_wall_.hit(ray_of(pixel));
  if (!point) return std::nullopt;
  const Eigen::Vector3d seen = point->xyz - eye_.xyz;
  const double azimuth = std::atan2(seen.x(), -seen.z());
  return PanoramaDirection{middle_azimuth_rad_ + wrapped_angle(azimuth - middle_azimuth_rad_),
                           seen.y() / std::hypot(seen.x(), seen.z())};
}

std::optional<Point<frame::Room>> ProjectorMap::wall_point_of(const Eigen::Vector2d& pixel) const {
  return wall_.hit(ray_of(pixel));
}

std::optional<Eigen::Vector2d> ProjectorMap::pixel_lighting(const Point<frame::Room>& point) const {
  const auto pixel = lens().pixel_of((T_projector_room_ * point).xyz);
  if (!pixel || !lens().contains(*pixel)) return std::nullopt;
  return pixel;
}

}  // namespace cyclorama
