// SPDX-License-Identifier: Apache-2.0
#include "common/room/read_wall.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/room/file_beside.h"

namespace cyclorama {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Range kMetres{-100.0, 100.0};
constexpr Range kSides{0.1, 100.0};
constexpr std::size_t kMaxPlanes = 64;
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;
constexpr double kMinPlaneWidth_m = 0.05;

Point<frame::Room> point_of(const std::vector<double>& xyz) { return {Eigen::Vector3d(xyz[0], xyz[1], xyz[2])}; }

struct Heights {
  double bottom_m = 0.0;
  double top_m = 1.0;
};
Heights read_heights(ConfigTable* table) {
  const Heights heights{table->number("bottom_m", {-10.0, 50.0}, 0.0), table->number("top_m", {-10.0, 50.0})};
  if (!(heights.top_m > heights.bottom_m)) table->refuse("top_m", "must be above bottom_m");
  return heights;
}

Wall read_cylinder(ConfigTable* table) {
  CylinderWall wall;
  wall.radius_m = table->number("radius_m", {0.5, 50.0});
  wall.arc_rad = table->number("arc_deg", {2.0, 360.0}) * kDegree;
  const Heights heights = read_heights(table);
  wall.bottom_m = heights.bottom_m;
  wall.top_m = heights.top_m;
  return wall;
}

WallRectangle read_rectangle(ConfigTable* table) {
  const Point<frame::Room> middle = point_of(table->numbers("centre_m", 3, kMetres));
  const double pan = table->number("pan_deg", {-360.0, 360.0}, 0.0) * kDegree;
  const double tilt = table->number("tilt_deg", {-90.0, 90.0}, 0.0) * kDegree;
  const double width = table->number("width_m", kSides);
  return WallRectangle::facing(middle, pan, tilt, width, table->number("height_m", kSides));
}

Wall read_planes(ConfigTable* table) {
  PlanesWall wall;
  const auto corners = table->points("corners_m", 2, kMetres);
  if (!corners.empty()) {
    const Heights heights = read_heights(table);
    if (corners.size() < 2) table->refuse("corners_m", "needs two corners or more, from the visitor's left to right");
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const Eigen::Vector2d left(corners[i][0], corners[i][1]);
      const Eigen::Vector2d right(corners[i + 1][0], corners[i + 1][1]);
      if (!((right - left).norm() >= kMinPlaneWidth_m)) {
        table->refuse("corners_m", fmt::format("has two corners within {} m; leave one out", kMinPlaneWidth_m));
        return wall;
      }
      wall.rectangles.push_back(WallRectangle::above(left, right, heights.bottom_m, heights.top_m));
    }
  }
  for (ConfigTable& plane : table->tables("plane")) wall.rectangles.push_back(read_rectangle(&plane));
  if (wall.rectangles.empty()) {
    table->refuse("corners_m", "is missing; give the corners as [[x, z], ...], or planes as [[wall.plane]]");
  }
  if (wall.rectangles.size() > kMaxPlanes) {
    table->refuse("corners_m", fmt::format("makes more than {} planes; describe the wall as a mesh", kMaxPlanes));
  }
  return wall;
}

Wall read_dome(ConfigTable* table) {
  DomeWall wall;
  wall.centre = point_of(table->numbers("centre_m", 3, kMetres));
  wall.radius_m = table->number("radius_m", {0.5, 50.0});
  wall.field_rad = table->number("field_deg", {10.0, 360.0}, 180.0) * kDegree;
  wall.tilt_rad = table->number("tilt_deg", {-90.0, 90.0}, 90.0) * kDegree;
  return wall;
}

std::optional<Wall> read_mesh(ConfigTable* table, const std::filesystem::path& folder) {
  const std::filesystem::path file = file_beside(table, "file", folder);
  if (file.empty()) return std::nullopt;
  const auto text = read_text_file(file, kMaxFileBytes);
  if (!text) {
    table->refuse("file", printable(text.error().message(), 300));
    return std::nullopt;
  }
  auto mesh = MeshWall::read(*text);
  if (mesh) return *std::move(mesh);
  table->refuse(
      "file", fmt::format("'{}' {}", printable(file.filename().string(), 100), printable(mesh.error().message(), 300)));
  return std::nullopt;
}

}  // namespace

std::optional<Wall> read_wall(ConfigTable table, const std::filesystem::path& folder) {
  const std::vector<std::string> shapes{"cylinder", "plane", "planes", "dome", "mesh"};
  const std::string shape = table.text("shape", "cylinder");
  if (std::ranges::find(shapes, shape) == shapes.end()) {
    table.choice("shape", shapes);  // Reports the invalid shape; keys of a particular shape are then not required.
    return std::nullopt;
  }
  if (shape == "plane") return PlanesWall{{read_rectangle(&table)}};
  if (shape == "planes") return read_planes(&table);
  if (shape == "dome") return read_dome(&table);
  if (shape == "mesh") return read_mesh(&table, folder);
  return read_cylinder(&table);
}

}  // namespace cyclorama
