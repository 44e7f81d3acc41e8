// SPDX-License-Identifier: Apache-2.0
#include "common/room/cylinder_wall.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace cyclorama {

std::optional<Point<frame::Room>> CylinderWall::hit(const RoomRay& ray) const {
  const double ox = ray.origin.xyz.x() - centre_x_m;
  const double oz = ray.origin.xyz.z() - centre_z_m;
  const double dx = ray.direction.x();
  const double dz = ray.direction.z();
  const double a = dx * dx + dz * dz;
  const double half_b = ox * dx + oz * dz;
  const double c = ox * ox + oz * oz - radius_m * radius_m;
  const double discriminant = half_b * half_b - a * c;
  if (!(a > 0.0) || !(discriminant >= 0.0)) return std::nullopt;
  // Computes the roots in the numerically stable way (Numerical Recipes 5.6), without differences of nearly equal
  // numbers.
  const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
  double nearer = q / a;
  double farther = q != 0.0 ? c / q : nearer;
  if (nearer > farther) std::swap(nearer, farther);
  for (const double t : {nearer, farther}) {
    if (!(t > 1e-9)) continue;
    const Point<frame::Room> point{ray.origin.xyz + t * ray.direction};
    const double outward = (point.xyz.x() - centre_x_m) * dx + (point.xyz.z() - centre_z_m) * dz;
    const bool from_inside = outward > 0.0;
    if (from_inside && point.xyz.y() >= bottom_m && point.xyz.y() <= top_m &&
        std::abs(arc_angle_of(point)) <= 0.5 * arc_rad) {
      return point;
    }
  }
  return std::nullopt;
}

std::optional<Point<frame::Room>> CylinderWall::hit_extended(const RoomRay& ray) const {
  CylinderWall endless = *this;
  endless.bottom_m = -std::numeric_limits<double>::infinity();
  endless.top_m = std::numeric_limits<double>::infinity();
  endless.arc_rad = 4.0 * std::numbers::pi;
  return endless.hit(ray);
}

std::vector<WallPatch> CylinderWall::patches(std::size_t about) const {
  const double length = radius_m * arc_rad;
  const double height = top_m - bottom_m;
  const double across = std::sqrt(static_cast<double>(about) * length / height);
  const int columns = std::max(1, static_cast<int>(std::lround(across)));
  const int rows = std::max(1, static_cast<int>(std::lround(static_cast<double>(about) / columns)));
  std::vector<WallPatch> patches;
  for (int i = 0; i < columns; ++i) {
    const double arc_angle = arc_rad * ((i + 0.5) / columns - 0.5);
    const Eigen::Vector3d normal(-std::sin(arc_angle), 0.0, std::cos(arc_angle));
    for (int j = 0; j < rows; ++j) {
      patches.push_back(
          {point_at(arc_angle, bottom_m + height * (j + 0.5) / rows), normal, length / columns * height / rows});
    }
  }
  return patches;
}

std::vector<Point<frame::Room>> CylinderWall::outline() const {
  constexpr int kSteps = 256;
  std::vector<Point<frame::Room>> points;
  for (int i = 0; i <= kSteps; ++i) {
    const double arc_angle = arc_rad * (static_cast<double>(i) / kSteps - 0.5);
    for (const double height : {bottom_m, top_m}) points.push_back(point_at(arc_angle, height));
  }
  return points;
}

bool CylinderWall::is_lit_from(const Point<frame::Room>& point) const {
  return std::hypot(point.xyz.x() - centre_x_m, point.xyz.z() - centre_z_m) < radius_m;
}

double CylinderWall::arc_angle_of(const Point<frame::Room>& point) const {
  return std::atan2(point.xyz.x() - centre_x_m, -(point.xyz.z() - centre_z_m));
}

Point<frame::Room> CylinderWall::point_at(double arc_angle, double height_m) const {
  return {Eigen::Vector3d(centre_x_m + radius_m * std::sin(arc_angle), height_m,
                          centre_z_m - radius_m * std::cos(arc_angle))};
}

}  // namespace cyclorama
