// SPDX-License-Identifier: Apache-2.0
#include "common/room/planes_wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace cyclorama {
namespace {

constexpr double kMinDistance = 1e-9;  // In units of the ray's direction; excludes the ray's origin.
constexpr double kSeam_m = 1e-9;       // Tolerance, so that rounding leaves no gap where rectangles meet.

/// Intersection of a ray from the lit side with the rectangle's plane.
struct PlaneHit {
  double along;  ///< In units of the ray's direction.
  Eigen::Vector3d point;
  double outside_m;  ///< Distance of the point from the rectangle; 0 inside it.
};

std::optional<PlaneHit> meet(const WallRectangle& r, const RoomRay& ray) {
  const Eigen::Vector3d normal = r.normal();
  const double towards = normal.dot(ray.direction);
  if (!(towards < 0.0)) return std::nullopt;
  const double along = normal.dot(r.middle.xyz - ray.origin.xyz) / towards;
  if (!(along > kMinDistance && along < std::numeric_limits<double>::infinity())) return std::nullopt;
  const Eigen::Vector3d point = ray.origin.xyz + along * ray.direction;
  const Eigen::Vector3d from_middle = point - r.middle.xyz;
  const double past_side = std::max(0.0, std::abs(r.right.dot(from_middle)) - 0.5 * r.width_m);
  const double past_end = std::max(0.0, std::abs(r.up.dot(from_middle)) - 0.5 * r.height_m);
  const double outside = std::hypot(past_side, past_end);
  if (!std::isfinite(outside)) return std::nullopt;
  return PlaneHit{along, point, outside <= kSeam_m ? 0.0 : outside};
}

}  // namespace

double solid_angle(const Eigen::Vector3d& seen_from, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                   const Eigen::Vector3d& c) {
  const Eigen::Vector3d to_a = a - seen_from;
  const Eigen::Vector3d to_b = b - seen_from;
  const Eigen::Vector3d to_c = c - seen_from;
  const double la = to_a.norm();
  const double lb = to_b.norm();
  const double lc = to_c.norm();
  const double volume = to_a.dot(to_b.cross(to_c));
  const double around = la * lb * lc + to_a.dot(to_b) * lc + to_b.dot(to_c) * la + to_c.dot(to_a) * lb;
  // Counter-clockwise corners, as seen from the point, give a negative volume.
  return -2.0 * std::atan2(volume, around);
}

WallRectangle WallRectangle::facing(const Point<frame::Room>& middle, double pan_rad, double tilt_rad, double width_m,
                                    double height_m) {
  const Eigen::Quaterniond aimed =
      Eigen::AngleAxisd(-pan_rad, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX());
  return {middle, aimed * Eigen::Vector3d::UnitX(), aimed * Eigen::Vector3d::UnitY(), width_m, height_m};
}

WallRectangle WallRectangle::above(const Eigen::Vector2d& left_xz, const Eigen::Vector2d& right_xz, double bottom_m,
                                   double top_m) {
  const Eigen::Vector2d middle = 0.5 * (left_xz + right_xz);
  const Eigen::Vector2d along = (right_xz - left_xz).normalized();
  return {{Eigen::Vector3d(middle.x(), 0.5 * (bottom_m + top_m), middle.y())},
          Eigen::Vector3d(along.x(), 0.0, along.y()),
          Eigen::Vector3d::UnitY(),
          (right_xz - left_xz).norm(),
          top_m - bottom_m};
}

std::optional<Point<frame::Room>> PlanesWall::hit(const RoomRay& ray) const {
  std::optional<PlaneHit> first;
  for (const WallRectangle& rectangle : rectangles) {
    const auto met = meet(rectangle, ray);
    if (met && met->outside_m == 0.0 && (!first || met->along < first->along)) first = met;
  }
  if (!first) return std::nullopt;
  return Point<frame::Room>{first->point};
}

std::optional<Point<frame::Room>> PlanesWall::hit_extended(const RoomRay& ray) const {
  if (auto exact = hit(ray)) return exact;
  std::optional<PlaneHit> nearest;
  for (const WallRectangle& rectangle : rectangles) {
    const auto met = meet(rectangle, ray);
    if (met && (!nearest || met->outside_m < nearest->outside_m)) nearest = met;
  }
  if (!nearest) return std::nullopt;
  return Point<frame::Room>{nearest->point};
}

std::vector<WallPatch> PlanesWall::patches(std::size_t about) const {
  double area = 0.0;
  for (const WallRectangle& r : rectangles) area += r.area_m2();
  const double side = std::sqrt(area / static_cast<double>(std::max<std::size_t>(about, 1)));
  std::vector<WallPatch> patches;
  for (const WallRectangle& r : rectangles) {
    const int columns = std::max(1, static_cast<int>(std::lround(r.width_m / side)));
    const int rows = std::max(1, static_cast<int>(std::lround(r.height_m / side)));
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        patches.push_back({r.point_at((2.0 * i + 1.0) / columns - 1.0, (2.0 * j + 1.0) / rows - 1.0), r.normal(),
                           r.area_m2() / columns / rows});
      }
    }
  }
  return patches;
}

std::vector<Point<frame::Room>> PlanesWall::outline() const {
  // Points inside the rectangles are included, since the elevation of a rectangle overhead is greatest in its middle.
  constexpr int kSteps = 64;
  std::vector<Point<frame::Room>> points;
  for (const WallRectangle& r : rectangles) {
    for (int j = 0; j <= kSteps; ++j) {
      for (int i = 0; i <= kSteps; ++i) points.push_back(r.point_at(2.0 * i / kSteps - 1.0, 2.0 * j / kSteps - 1.0));
    }
  }
  return points;
}

std::vector<WallEdge> PlanesWall::creases() const {
  std::vector<WallEdge> edges;
  if (rectangles.size() < 2) return edges;
  for (const WallRectangle& r : rectangles) {
    const Point<frame::Room> corners[] = {r.point_at(-1, -1), r.point_at(1, -1), r.point_at(1, 1), r.point_at(-1, 1)};
    for (std::size_t i = 0; i < 4; ++i) edges.push_back({corners[i], corners[(i + 1) % 4]});
  }
  return edges;
}

bool PlanesWall::is_lit_from(const Point<frame::Room>& point) const {
  double seen = 0.0;
  for (const WallRectangle& r : rectangles) {
    const Eigen::Vector3d a = r.point_at(-1, -1).xyz;
    const Eigen::Vector3d c = r.point_at(1, 1).xyz;
    seen += solid_angle(point.xyz, a, r.point_at(1, -1).xyz, c) + solid_angle(point.xyz, a, c, r.point_at(-1, 1).xyz);
  }
  return seen > 0.0;
}

}  // namespace cyclorama
