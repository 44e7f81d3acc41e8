// SPDX-License-Identifier: Apache-2.0
#include "common/room/dome_wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cyclorama {

std::optional<Point<frame::Room>> DomeWall::hit_extended(const RoomRay& ray) const {
  // A ray from inside meets the sphere at the farther of its two intersections. The computation starts from the ray's
  // point nearest to the centre, so that nothing cancels.
  const double length2 = ray.direction.squaredNorm();
  if (!(length2 > 0.0)) return std::nullopt;
  const Eigen::Vector3d from_centre = ray.origin.xyz - centre.xyz;
  const double nearest = -from_centre.dot(ray.direction) / length2;
  const double miss2 = (from_centre + nearest * ray.direction).squaredNorm();
  const double half_chord2 = (radius_m * radius_m - miss2) / length2;
  if (!(half_chord2 > 0.0)) return std::nullopt;
  const double along = nearest + std::sqrt(half_chord2);
  if (!(along > 1e-9)) return std::nullopt;
  return Point<frame::Room>{ray.origin.xyz + along * ray.direction};
}

std::optional<Point<frame::Room>> DomeWall::hit(const RoomRay& ray) const {
  const auto point = hit_extended(ray);
  if (!point) return std::nullopt;
  const Eigen::Vector3d outwards = point->xyz - centre.xyz;
  const Eigen::Vector3d along = axis();
  const double from_axis = std::atan2(outwards.cross(along).norm(), outwards.dot(along));
  if (!(from_axis <= 0.5 * field_rad)) return std::nullopt;
  return point;
}

std::vector<WallPatch> DomeWall::patches(std::size_t about) const {
  // Zones of equal height have equal area (Archimedes).
  const double height = 1.0 - std::cos(0.5 * field_rad);
  const int zones = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(about) / 2.0))));
  const int sectors = std::max(3, static_cast<int>(about) / zones);
  std::vector<WallPatch> patches;
  for (int i = 0; i < zones; ++i) {
    const double from_axis = std::acos(std::clamp(1.0 - height * (i + 0.5) / zones, -1.0, 1.0));
    for (int j = 0; j < sectors; ++j) {
      const Point<frame::Room> middle = point_at(from_axis, 2.0 * std::numbers::pi * (j + 0.5) / sectors);
      patches.push_back({middle, (centre.xyz - middle.xyz) / radius_m,
                         2.0 * std::numbers::pi * radius_m * radius_m * height / zones / sectors});
    }
  }
  return patches;
}

std::vector<Point<frame::Room>> DomeWall::outline() const {
  constexpr int kRings = 32;
  constexpr int kSteps = 128;
  std::vector<Point<frame::Room>> points;
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      points.push_back(point_at(0.5 * field_rad * i / kRings, 2.0 * std::numbers::pi * j / kSteps));
    }
  }
  return points;
}

bool DomeWall::is_lit_from(const Point<frame::Room>& point) const { return (point.xyz - centre.xyz).norm() < radius_m; }

Eigen::Vector3d DomeWall::axis() const { return {0.0, std::sin(tilt_rad), -std::cos(tilt_rad)}; }

Point<frame::Room> DomeWall::point_at(double from_axis_rad, double around_rad) const {
  const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d up = right.cross(axis());
  const Eigen::Vector3d sideways = std::cos(around_rad) * right + std::sin(around_rad) * up;
  return {centre.xyz + radius_m * (std::cos(from_axis_rad) * axis() + std::sin(from_axis_rad) * sideways)};
}

}  // namespace cyclorama
