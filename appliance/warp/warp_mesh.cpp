// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/warp_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cyclorama {
namespace {

constexpr int kFewestCells = 4;
constexpr int kSamplesPerCell = 4;  // Each way; a cell's largest error lies in its middle or on the middle of an edge.

WarpMesh sampled(const ProjectorMap& map, int cells_x, int cells_y) {
  WarpMesh mesh{map.lens().width_px, map.lens().height_px, cells_x, cells_y, {}, 0.0};
  mesh.vertices.reserve(static_cast<std::size_t>(cells_x + 1) * static_cast<std::size_t>(cells_y + 1));
  for (int j = 0; j <= cells_y; ++j) {
    for (int i = 0; i <= cells_x; ++i) {
      const Eigen::Vector2d pixel(static_cast<double>(mesh.width_px) * i / cells_x,
                                  static_cast<double>(mesh.height_px) * j / cells_y);
      constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
      WarpVertex vertex{static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), kNone, kNone};
      if (const auto direction = map.direction_of(pixel)) {
        vertex.azimuth_rad = static_cast<float>(direction->azimuth_rad);
        vertex.tan_elevation = static_cast<float>(direction->tan_elevation);
      }
      mesh.vertices.push_back(vertex);
    }
  }
  return mesh;
}

/// Infinity when a pixel that meets the wall lies in no triangle.
double worst_error(const ProjectorMap& map, const WarpMesh& mesh, const Panorama& picture) {
  const double px_per_tan = picture.height_px / (picture.tan_elevation_top - picture.tan_elevation_bottom);
  const int across = mesh.cells_x * kSamplesPerCell;
  const int down = mesh.cells_y * kSamplesPerCell;
  double worst = 0.0;
  for (int j = 0; j <= down; ++j) {
    for (int i = 0; i <= across; ++i) {
      const Eigen::Vector2d pixel(static_cast<double>(mesh.width_px) * i / across,
                                  static_cast<double>(mesh.height_px) * j / down);
      if (!map.wall_point_of(pixel)) continue;
      const auto exact = map.direction_of(pixel);
      const auto meshed = mesh.interpolate(pixel);
      if (!exact || !meshed) return std::numeric_limits<double>::infinity();
      worst = std::max(worst, std::hypot((exact->azimuth_rad - meshed->azimuth_rad) / picture.radians_per_px(),
                                         (exact->tan_elevation - meshed->tan_elevation) * px_per_tan));
    }
  }
  return worst;
}

}  // namespace

std::vector<std::uint32_t> WarpMesh::triangles() const {
  std::vector<std::uint32_t> indices;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (vertices[a].is_valid() && vertices[b].is_valid() && vertices[c].is_valid())
      indices.insert(indices.end(), {a, b, c});
  };
  const auto row = static_cast<std::uint32_t>(cells_x + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(cells_y); ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t corner = j * row + i;
      add(corner, corner + row + 1, corner + 1);
      add(corner, corner + row, corner + row + 1);
    }
  }
  return indices;
}

std::optional<PanoramaDirection> WarpMesh::interpolate(const Eigen::Vector2d& pixel) const {
  const double x = std::clamp(pixel.x() / width_px * cells_x, 0.0, static_cast<double>(cells_x));
  const double y = std::clamp(pixel.y() / height_px * cells_y, 0.0, static_cast<double>(cells_y));
  const int i = std::min(static_cast<int>(x), cells_x - 1);
  const int j = std::min(static_cast<int>(y), cells_y - 1);
  const double fx = x - i;
  const double fy = y - j;
  const auto at = [&](int column, int line) -> const WarpVertex& {
    return vertices[static_cast<std::size_t>(line) * static_cast<std::size_t>(cells_x + 1) +
                    static_cast<std::size_t>(column)];
  };
  const WarpVertex& first = at(i, j);
  const WarpVertex& last = at(i + 1, j + 1);
  const bool upper = fx >= fy;
  const WarpVertex& side = upper ? at(i + 1, j) : at(i, j + 1);
  if (!first.is_valid() || !last.is_valid() || !side.is_valid()) return std::nullopt;
  const double weight_last = upper ? fy : fx;
  const double weight_side = upper ? fx - fy : fy - fx;
  const double weight_first = 1.0 - weight_last - weight_side;
  const auto mix = [&](float a, float b, float c) {
    return weight_first * static_cast<double>(a) + weight_side * static_cast<double>(b) +
           weight_last * static_cast<double>(c);
  };
  return PanoramaDirection{mix(first.azimuth_rad, side.azimuth_rad, last.azimuth_rad),
                           mix(first.tan_elevation, side.tan_elevation, last.tan_elevation)};
}

Result<WarpMesh> make_warp_mesh(const ProjectorMap& map, const Panorama& picture, double tolerance_px) {
  TRY(picture.validate());
  const Pinhole& lens = map.lens();
  const auto meshed = [&](int cells_x, int cells_y) {
    WarpMesh mesh = sampled(map, std::min(cells_x, lens.width_px), std::min(cells_y, lens.height_px));
    mesh.worst_error_px = worst_error(map, mesh, picture);
    return mesh;
  };
  WarpMesh mesh = meshed(kFewestCells, kFewestCells);
  while (!(mesh.worst_error_px <= tolerance_px)) {
    if (mesh.cells_x == lens.width_px && mesh.cells_y == lens.height_px) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("no warp mesh holds {} px (the finest is off by {:.2f} px): the projector is too near the "
                      "wall or meets it at a grazing angle; move it",
                      tolerance_px, mesh.worst_error_px));
    }
    // Halve the cells along the direction that gains more: a cylinder bends across and is nearly straight upwards.
    WarpMesh narrower = meshed(2 * mesh.cells_x, mesh.cells_y);
    WarpMesh flatter = meshed(mesh.cells_x, 2 * mesh.cells_y);
    const bool is_wide = mesh.cells_x < lens.width_px;
    const bool is_high = mesh.cells_y < lens.height_px;
    const bool across = is_wide && (!is_high || narrower.worst_error_px <= flatter.worst_error_px);
    mesh = across ? std::move(narrower) : std::move(flatter);
  }
  return mesh;
}

}  // namespace cyclorama
