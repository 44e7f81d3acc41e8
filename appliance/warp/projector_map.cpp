// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/projector_map.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::warp {
namespace {

constexpr double kInFront_m = 1e-3;  // Distance from the lens below which points are clipped.

/// True if a part of the segment lies in the picture (Liang and Barsky, ACM TOG 3(1), 1984).
bool crosses(const Pinhole& lens, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  double from = 0.0;
  double to = 1.0;
  const Eigen::Vector2d size(lens.width_px, lens.height_px);
  for (int axis = 0; axis < 2; ++axis) {
    const double step = b[axis] - a[axis];
    if (step == 0.0 && !(a[axis] >= 0.0 && a[axis] <= size[axis])) return false;
    if (step == 0.0) continue;
    const double low = -a[axis] / step;
    const double high = (size[axis] - a[axis]) / step;
    from = std::max(from, std::min(low, high));
    to = std::min(to, std::max(low, high));
  }
  return from <= to;
}

}  // namespace

PicturePlace counted_near(const PicturePlace& position, const PictureShape& picture, double middle_rad) {
  if (!std::holds_alternative<Panorama>(picture)) return position;
  return {middle_rad + wrapped_angle(position.across - middle_rad), position.up};
}

ProjectorMap::ProjectorMap(const Installation& installation, std::size_t projector)
    : wall_(installation.wall), eye_(installation.sweet_spot) {
  CHECK(projector < installation.projectors.size());
  projector_ = installation.projectors[projector];
  T_projector_room_ = projector_.T_room_projector.inverse();
  const auto middle = view_direction_of({0.5 * lens().width_px, 0.5 * lens().height_px});
  if (middle) middle_azimuth_rad_ = std::atan2(middle->x(), -middle->z());
}

RoomRay ProjectorMap::ray_of(const Eigen::Vector2d& pixel) const {
  return {{projector_.T_room_projector.translation()},
          projector_.T_room_projector.rotation() * lens().direction_at(pixel.x(), pixel.y())};
}

std::vector<Eigen::Hyperplane<double, 2>> ProjectorMap::creases() const {
  std::vector<Eigen::Hyperplane<double, 2>> lines;
  for (const WallEdge& edge : cyclorama::creases(wall_)) {
    Eigen::Vector3d from = (T_projector_room_ * edge.from).xyz;
    Eigen::Vector3d to = (T_projector_room_ * edge.to).xyz;
    if (from.z() > to.z()) std::swap(from, to);
    if (!(to.z() > kInFront_m)) continue;
    if (from.z() < kInFront_m) from += (kInFront_m - from.z()) / (to.z() - from.z()) * (to - from);
    const Eigen::Vector2d a = *lens().pixel_of(from);
    const Eigen::Vector2d b = *lens().pixel_of(to);
    if ((b - a).norm() < 1e-6 || !crosses(lens(), a, b)) continue;
    lines.push_back(Eigen::Hyperplane<double, 2>::Through(a, b));
  }
  return lines;
}

std::optional<Eigen::Vector3d> ProjectorMap::view_direction_of(const Eigen::Vector2d& pixel) const {
  const auto point = hit_extended(wall_, ray_of(pixel));
  if (!point) return std::nullopt;
  return point->xyz - eye_.xyz;
}

std::optional<PicturePlace> ProjectorMap::place_of(const Eigen::Vector2d& pixel, const PictureShape& picture) const {
  const auto direction = view_direction_of(pixel);
  const auto position = direction ? cyclorama::place_of(picture, *direction) : std::nullopt;
  if (!position) return std::nullopt;
  return counted_near(*position, picture, middle_azimuth_rad_);
}

std::optional<PanoramaDirection> ProjectorMap::direction_of(const Eigen::Vector2d& pixel) const {
  const auto position = place_of(pixel, Panorama{});
  if (!position) return std::nullopt;
  return PanoramaDirection{position->across, position->up};
}

std::optional<Point<frame::Room>> ProjectorMap::wall_point_of(const Eigen::Vector2d& pixel) const {
  return hit(wall_, ray_of(pixel));
}

std::optional<Eigen::Vector2d> ProjectorMap::pixel_lighting(const Point<frame::Room>& point) const {
  const auto pixel = lens().pixel_of((T_projector_room_ * point).xyz);
  if (!pixel || !lens().contains(*pixel)) return std::nullopt;
  if (!is_reached(wall_, point, {projector_.T_room_projector.translation()})) return std::nullopt;
  return pixel;
}

}  // namespace cyclorama::warp
