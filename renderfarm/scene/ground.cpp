// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/ground.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "renderfarm/scene/area.h"
#include "renderfarm/scene/outline.h"

namespace cyclorama::scene {
namespace {

constexpr double kHeadroomM = 0.15;
constexpr double kStepOver = 0.25;  // Share of the eye's height; lower obstacles do not stop a visitor.
constexpr double kUneven = 0.4;     // Share of the eye's height; ground that is at most this much lower is walkable.
constexpr double kWallDistanceM = 0.3;
constexpr std::size_t kMaxCorners = 512;

bool has_ground(const SpaceGrid& grid, int x, int z, const Standing& standing) {
  const Eigen::Vector3d min(0, standing.floor - kUneven * standing.eye_height_m(), 0);
  const Eigen::Vector3d max(0, standing.floor + kStepOver * standing.eye_height_m(), 0);
  const int last = grid.cell_of(max).y();
  for (Eigen::Vector3i cell(x, grid.cell_of(min).y(), z); cell.y() <= last; ++cell.y()) {
    if (grid.is_solid(cell)) return true;
  }
  return false;
}

/// Returns the columns with ground and with room for a body. Scans have small holes, so ground in a neighbouring column
/// suffices.
CellSet free_columns(const SpaceGrid& grid, const Standing& standing) {
  CellSet ground(grid.cells().x(), grid.cells().z());
  for (int z = 0; z < ground.depth(); ++z) {
    for (int x = 0; x < ground.width(); ++x) {
      if (has_ground(grid, x, z, standing)) ground.add(x, z);
    }
  }
  CellSet free(ground.width(), ground.depth());
  for (int z = 0; z < free.depth(); ++z) {
    for (int x = 0; x < free.width(); ++x) {
      bool near_ground = false;
      for (int i = 0; i < 9; ++i) near_ground = near_ground || ground.has(x + i % 3 - 1, z + i / 3 - 1);
      const Eigen::Vector3d centre = grid.centre_of({x, 0, z});
      if (near_ground && body_fits(grid, centre.x(), centre.z(), standing.floor, standing.eye_height_m()))
        free.add(x, z);
    }
  }
  return free;
}

/// Returns the columns whose neighbours up to `cells` away are free too.
CellSet eroded(const CellSet& free, int cells) {
  CellSet inner(free.width(), free.depth());
  for (int z = 0; z < free.depth(); ++z) {
    for (int x = 0; x < free.width(); ++x) {
      bool clear = true;
      for (int dz = -cells; clear && dz <= cells; ++dz) {
        for (int dx = -cells; clear && dx <= cells; ++dx) clear = free.has(x + dx, z + dz);
      }
      if (clear) inner.add(x, z);
    }
  }
  return inner;
}

/// Returns the columns that can be reached from the visitor's position, at some distance from obstacles; nothing if the
/// visitor cannot take a step.
std::optional<CellSet> reached_columns(const SpaceGrid& grid, const Standing& standing) {
  const Eigen::Vector3i start = grid.cell_of(standing.eye);
  const CellSet free = free_columns(grid, standing);
  if (!free.has(start.x(), start.z())) return std::nullopt;
  // Distance from walls, in cells. If the start is nearer to a wall, the greatest possible distance is used instead.
  int distance = std::max(1, static_cast<int>(std::ceil(kWallDistanceM / grid.cell_m())));
  CellSet roomy = eroded(free, distance);
  while (!roomy.has(start.x(), start.z())) roomy = eroded(free, --distance);
  return reached_from(roomy, start.x(), start.z());
}

}  // namespace

bool body_fits(const SpaceGrid& grid, double x, double z, double floor, double eye_height_m) {
  Eigen::Vector3i cell = grid.cell_of({x, floor + kStepOver * eye_height_m, z});
  const int above_floor = grid.cell_of({x, floor, z}).y() + 1;
  const int last = grid.cell_of({x, floor + eye_height_m + kHeadroomM, z}).y();
  for (cell.y() = std::max(cell.y(), above_floor); cell.y() <= last; ++cell.y()) {
    if (grid.is_solid(cell)) return false;
  }
  return true;
}

double walkable_area_m2(const SpaceGrid& grid, const Standing& standing) {
  const std::optional<CellSet> reached = reached_columns(grid, standing);
  return reached ? static_cast<double>(reached->size()) * grid.cell_m() * grid.cell_m() : 0.0;
}

std::vector<Eigen::Vector2d> walkable_outline(const SpaceGrid& grid, const Standing& standing) {
  const std::optional<CellSet> reached = reached_columns(grid, standing);
  if (!reached) return {};
  std::vector<Eigen::Vector2d> corners;
  const Eigen::Vector3d origin = grid.centre_of({0, 0, 0}).array() - 0.5 * grid.cell_m();
  const auto borders = borders_of(*reached);
  for (const Eigen::Vector2i& corner : borders.front()) {
    corners.emplace_back(origin.x() + corner.x() * grid.cell_m(), origin.z() + corner.y() * grid.cell_m());
  }
  // Replaces stairs of cells by slopes, unless that excludes the eye. With a tolerance of less than half a cell, the
  // centre of the eye's cell stays inside.
  for (double tolerance = 0.75; tolerance < 64.0; tolerance *= 2.0) {
    const std::vector<Eigen::Vector2d> simple = simplified(corners, tolerance * grid.cell_m());
    if (simple.size() <= kMaxCorners && is_inside(simple, {standing.eye.x(), standing.eye.z()})) return simple;
  }
  std::vector<Eigen::Vector2d> exact = simplified(corners, 0.4 * grid.cell_m());
  if (exact.size() > kMaxCorners || !is_inside(exact, {standing.eye.x(), standing.eye.z()})) exact.clear();
  return exact;
}

}  // namespace cyclorama::scene
