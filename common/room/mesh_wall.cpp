// SPDX-License-Identifier: Apache-2.0
#include "common/room/mesh_wall.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/room/obj_surface.h"
#include "common/room/triangle_tree.h"

namespace cyclorama {
namespace {

/// Minimum angle of a crease; fine cells approximate smaller folds.
constexpr double kCrease = 10.0 * std::numbers::pi / 180.0;
constexpr std::size_t kOutlinePoints = 16384;

Eigen::Vector3d doubled_area(const TriangleCorners& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }

Point<frame::Room> between(const TriangleCorners& t, double b, double c) {
  return {(1.0 - b - c) * t[0] + b * t[1] + c * t[2]};
}

/// Returns the number of pieces per side that gives each piece an area of about `area_each`.
int pieces(const TriangleCorners& t, double area_each) {
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(0.5 * doubled_area(t).norm() / area_each))), 1, 256);
}

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double part = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - part * along).norm();
}

}  // namespace

struct MeshWall::Surface {
  TriangleTree tree;
  double area_m2 = 0.0;
  std::vector<WallEdge> creases;
  struct Rim {
    Eigen::Vector3d a;
    Eigen::Vector3d b;
    Eigen::Vector3d normal;  ///< Unit normal of the edge's triangle.
  };
  std::vector<Rim> rim;
};

Result<MeshWall> MeshWall::read(std::string_view obj_text) {
  TRY_ASSIGN(const ObjSurface read, read_obj_surface(obj_text));
  auto surface = std::make_shared<Surface>();
  const auto at = [&](std::uint32_t position) { return read.positions[position]; };
  std::vector<TriangleCorners> triangles;
  std::vector<Eigen::Vector3d> normals;
  for (const auto& t : read.triangles) {
    triangles.push_back({at(t[0]), at(t[1]), at(t[2])});
    const Eigen::Vector3d twice = doubled_area(triangles.back());
    normals.push_back(twice.normalized());
    surface->area_m2 += 0.5 * twice.norm();
  }
  std::vector<std::pair<double, WallEdge>> sharp;
  for (const ObjEdge& edge : edges_of(read)) {
    const Eigen::Vector3d& first = normals[edge.triangle];
    if (!edge.other) {
      surface->rim.push_back({at(edge.from), at(edge.to), first});
      continue;
    }
    const Eigen::Vector3d& second = normals[*edge.other];
    const double angle = std::atan2(first.cross(second).norm(), first.dot(second));
    if (angle > kCrease) sharp.push_back({angle, {{at(edge.from)}, {at(edge.to)}}});
  }
  std::ranges::stable_sort(sharp, std::greater(), [](const auto& entry) { return entry.first; });
  for (const auto& entry : sharp) surface->creases.push_back(entry.second);
  surface->tree = TriangleTree(std::move(triangles));
  return MeshWall(std::move(surface));
}

std::optional<Point<frame::Room>> MeshWall::hit(const RoomRay& ray) const {
  const auto met = surface_->tree.hit(ray.origin.xyz, ray.direction);
  if (!met) return std::nullopt;
  return Point<frame::Room>{ray.origin.xyz + met->along * ray.direction};
}

std::optional<Point<frame::Room>> MeshWall::hit_extended(const RoomRay& ray) const {
  if (auto exact = hit(ray)) return exact;
  std::optional<Point<frame::Room>> nearest;
  double min = std::numeric_limits<double>::infinity();
  for (const Surface::Rim& rim : surface_->rim) {
    const double towards = rim.normal.dot(ray.direction);
    if (!(towards < 0.0)) continue;
    const double along = rim.normal.dot(rim.a - ray.origin.xyz) / towards;
    if (!(along > 1e-9 && std::isfinite(along))) continue;
    const Eigen::Vector3d point = ray.origin.xyz + along * ray.direction;
    const double outside = distance_to_segment(point, rim.a, rim.b);
    if (outside < min) {
      min = outside;
      nearest = Point<frame::Room>{point};
    }
  }
  return nearest;
}

std::vector<WallPatch> MeshWall::patches(std::size_t about) const {
  const double each = surface_->area_m2 / static_cast<double>(std::max<std::size_t>(about, 1));
  std::vector<WallPatch> patches;
  for (const TriangleCorners& t : surface_->tree.triangles()) {
    const Eigen::Vector3d twice = doubled_area(t);
    const int n = pieces(t, each);
    for (int j = 0; j < n; ++j) {
      // A row of upright triangles with inverted triangles between them.
      for (int i = 0; i < 2 * (n - j) - 1; ++i) {
        const double lift = i % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
        patches.push_back(
            {between(t, (i / 2 + lift) / n, (j + lift) / n), twice.normalized(), 0.5 * twice.norm() / n / n});
      }
    }
  }
  return patches;
}

std::vector<Point<frame::Room>> MeshWall::outline() const {
  std::vector<Point<frame::Room>> points;
  for (const TriangleCorners& t : surface_->tree.triangles()) {
    const int n = pieces(t, surface_->area_m2 / kOutlinePoints);
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i + j <= n; ++i)
        points.push_back(between(t, static_cast<double>(i) / n, static_cast<double>(j) / n));
    }
  }
  return points;
}

std::vector<WallEdge> MeshWall::creases() const { return surface_->creases; }

bool MeshWall::is_lit_from(const Point<frame::Room>& point) const {
  double seen = 0.0;
  for (const TriangleCorners& t : surface_->tree.triangles()) seen += solid_angle(point.xyz, t[0], t[1], t[2]);
  return seen > 0.0;
}

std::size_t MeshWall::triangle_count() const { return surface_->tree.triangles().size(); }

}  // namespace cyclorama
