// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/walkable/walkable_picture.h"

#include <algorithm>
#include <array>
#include <vector>

#include "common/image/draw.h"

namespace cyclorama::walkable {
namespace {

constexpr int kSidePx = 1000;
constexpr int kBorderCells = 8;

Colour colour_of(GroundKind kind) {
  switch (kind) {
    case GroundKind::kWalkable:
      return {60, 140, 70};
    case GroundKind::kBlocked:
      return {150, 50, 45};
    case GroundKind::kSteep:
      return {190, 120, 40};
    case GroundKind::kNone:
      return {45, 60, 120};
    case GroundKind::kUnseen:
      break;
  }
  return {12, 12, 14};
}

}  // namespace

RgbImage walkable_picture(const WalkableGround& ground, const scene::SceneInfo& info) {
  const auto kind_at = [&](int x, int z) {
    if (x < 0 || z < 0 || x >= ground.width || z >= ground.depth) return GroundKind::kUnseen;
    return ground
        .kinds[static_cast<std::size_t>(z) * static_cast<std::size_t>(ground.width) + static_cast<std::size_t>(x)];
  };
  Eigen::Vector2i min(ground.width, ground.depth);
  Eigen::Vector2i max(0, 0);
  for (int z = 0; z < ground.depth; ++z) {
    for (int x = 0; x < ground.width; ++x) {
      if (kind_at(x, z) == GroundKind::kUnseen) continue;
      min = min.cwiseMin(Eigen::Vector2i(x, z));
      max = max.cwiseMax(Eigen::Vector2i(x, z));
    }
  }
  min.array() -= kBorderCells;
  max.array() += kBorderCells + 1;
  const Eigen::Vector2i cells = (max - min).cwiseMax(1);
  const double px_per_cell = std::min(16.0, double{kSidePx} / cells.maxCoeff());
  const auto width = static_cast<int>(cells.x() * px_per_cell) + 1;
  const auto height = static_cast<int>(cells.y() * px_per_cell) + 1;
  RgbImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Colour colour =
          colour_of(kind_at(min.x() + static_cast<int>(x / px_per_cell), min.y() + static_cast<int>(y / px_per_cell)));
      std::copy(colour.begin(), colour.end(), picture.at(x, y));
    }
  }
  const auto pixel_of = [&](const Eigen::Vector2d& p) -> std::array<double, 2> {
    const Eigen::Vector2d cell = (p - ground.min) / ground.cell_m - min.cast<double>();
    return {cell.x() * px_per_cell, cell.y() * px_per_cell};
  };
  const auto draw = [&](const std::vector<Eigen::Vector2d>& polygon, Colour colour, int line_px) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
      draw_line(&picture, pixel_of(polygon[i]), pixel_of(polygon[(i + 1) % polygon.size()]), colour, line_px);
  };
  draw(info.walkable, {60, 200, 220}, 1);
  for (const auto& hole : info.walkable_holes) draw(hole, {60, 200, 220}, 1);
  draw(ground.outline, {255, 255, 255}, 3);
  for (const auto& hole : ground.holes) draw(hole, {250, 220, 60}, 3);
  const auto cross = [&](const Eigen::Vector3d& eye, double size_px, Colour colour) {
    const auto [x, y] = pixel_of({eye.x(), eye.z()});
    draw_line(&picture, {x - size_px, y}, {x + size_px, y}, colour, 3);
    draw_line(&picture, {x, y - size_px}, {x, y + size_px}, colour, 3);
  };
  for (const scene::SceneTourStop& stop : info.stops) cross(stop.eye, 3.0, {240, 120, 240});
  cross(info.start_eye, 8.0, {255, 255, 255});
  return picture;
}

}  // namespace cyclorama::walkable
