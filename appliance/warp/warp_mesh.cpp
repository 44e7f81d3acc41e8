// SPDX-License-Identifier: Apache-2.0
#include "appliance/warp/warp_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "appliance/warp/cut_cells.h"

namespace cyclorama::warp {
namespace {

constexpr int kMinCells = 4;
constexpr double kAlike = 1.1;
// In each direction; a cell's error is largest in its middle or in the middle of an edge.
constexpr int kSamplesPerCell = 4;

/// Maximum number of creases along which a free-form wall's cells are cut, the sharpest first; fine cells approximate
/// the other creases.
constexpr std::size_t kMaxLines = 256;

WarpMesh sampled(const ProjectorMap& map, const PictureShape& picture,
                 const std::vector<Eigen::Hyperplane<double, 2>>& creases, int cells_x, int cells_y) {
  WarpMesh mesh{map.lens().width_px, map.lens().height_px, cells_x, cells_y, {}, 0.0};
  CutGrid grid = cut_grid(Eigen::Vector2d(mesh.width_px, mesh.height_px), cells_x, cells_y, creases);
  mesh.cuts = std::move(grid.cuts);
  mesh.vertices.reserve(grid.positions.size());
  for (const Eigen::Vector2d& pixel : grid.positions) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    WarpVertex vertex{static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), kNone, kNone};
    if (const auto position = map.place_of(pixel, picture)) {
      vertex.azimuth_rad = static_cast<float>(position->across);
      vertex.tan_elevation = static_cast<float>(position->up);
    }
    mesh.vertices.push_back(vertex);
  }
  return mesh;
}

/// Returns the mesh's maximum error on the wall; infinity if a pixel that meets the wall lies in no triangle.
double worst_error(const ProjectorMap& map, const WarpMesh& mesh, const PictureShape& picture) {
  const PixelScale scale = pixel_scale(picture);
  const int across = mesh.cells_x * kSamplesPerCell;
  const int down = mesh.cells_y * kSamplesPerCell;
  double worst = 0.0;
  for (int j = 0; j <= down; ++j) {
    for (int i = 0; i <= across; ++i) {
      const Eigen::Vector2d pixel(static_cast<double>(mesh.width_px) * i / across,
                                  static_cast<double>(mesh.height_px) * j / down);
      if (!map.wall_point_of(pixel)) continue;
      const auto exact = map.place_of(pixel, picture);
      const auto meshed = mesh.interpolate(pixel);
      if (!exact || !meshed) return std::numeric_limits<double>::infinity();
      worst = std::max(worst, scale.distance_px(*exact, {meshed->azimuth_rad, meshed->tan_elevation}));
    }
  }
  return worst;
}

/// Interpolates between three corners; the weights add up to 1.
std::optional<PanoramaDirection> mixed(const WarpVertex& a, double of_a, const WarpVertex& b, double of_b,
                                       const WarpVertex& c, double of_c) {
  if (!a.is_valid() || !b.is_valid() || !c.is_valid()) return std::nullopt;
  const auto mix = [&](float x, float y, float z) {
    return of_a * static_cast<double>(x) + of_b * static_cast<double>(y) + of_c * static_cast<double>(z);
  };
  return PanoramaDirection{mix(a.azimuth_rad, b.azimuth_rad, c.azimuth_rad),
                           mix(a.tan_elevation, b.tan_elevation, c.tan_elevation)};
}

/// Interpolates in the triangle of a cut cell that contains `pixel`, or that is nearest to it.
std::optional<PanoramaDirection> in_cut_cell(const CutCell& cell, const std::vector<WarpVertex>& vertices,
                                             const Eigen::Vector2d& pixel) {
  const auto at = [](const WarpVertex& v) { return Eigen::Vector2d(v.x_px, v.y_px); };
  const auto doubled_area = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    return p.x() * q.y() - p.y() * q.x();
  };
  std::optional<PanoramaDirection> found;
  double deepest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 2 < cell.corners.size(); i += 3) {
    const WarpVertex& a = vertices[cell.corners[i]];
    const WarpVertex& b = vertices[cell.corners[i + 1]];
    const WarpVertex& c = vertices[cell.corners[i + 2]];
    const Eigen::Vector2d ab = at(b) - at(a);
    const Eigen::Vector2d ac = at(c) - at(a);
    const double whole = doubled_area(ab, ac);
    if (whole == 0.0) continue;
    const double of_b = doubled_area(pixel - at(a), ac) / whole;
    const double of_c = doubled_area(ab, pixel - at(a)) / whole;
    const double of_a = 1.0 - of_b - of_c;
    const double depth = std::min({of_a, of_b, of_c});
    if (!(depth > deepest)) continue;
    deepest = depth;
    found = mixed(a, of_a, b, of_b, c, of_c);
  }
  return found;
}

}  // namespace

std::vector<std::uint32_t> WarpMesh::triangles() const {
  std::vector<std::uint32_t> indices;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (vertices[a].is_valid() && vertices[b].is_valid() && vertices[c].is_valid())
      indices.insert(indices.end(), {a, b, c});
  };
  const auto row = static_cast<std::uint32_t>(cells_x + 1);
  auto cut = cuts.begin();
  for (int cell = 0; cell < cells_x * cells_y; ++cell) {
    if (cut != cuts.end() && cut->cell == cell) {
      for (std::size_t i = 0; i + 2 < cut->corners.size(); i += 3) {
        add(cut->corners[i], cut->corners[i + 1], cut->corners[i + 2]);
      }
      ++cut;
      continue;
    }
    const auto corner = static_cast<std::uint32_t>(cell / cells_x) * row + static_cast<std::uint32_t>(cell % cells_x);
    add(corner, corner + row + 1, corner + 1);
    add(corner, corner + row, corner + row + 1);
  }
  return indices;
}

std::optional<PanoramaDirection> WarpMesh::interpolate(const Eigen::Vector2d& pixel) const {
  const double x = std::clamp(pixel.x() / width_px * cells_x, 0.0, static_cast<double>(cells_x));
  const double y = std::clamp(pixel.y() / height_px * cells_y, 0.0, static_cast<double>(cells_y));
  const int i = std::min(static_cast<int>(x), cells_x - 1);
  const int j = std::min(static_cast<int>(y), cells_y - 1);
  const auto cut = std::ranges::lower_bound(cuts, j * cells_x + i, {}, &CutCell::cell);
  if (cut != cuts.end() && cut->cell == j * cells_x + i) return in_cut_cell(*cut, vertices, pixel);
  const double fx = x - i;
  const double fy = y - j;
  const auto at = [&](int column, int line) -> const WarpVertex& {
    return vertices[static_cast<std::size_t>(line) * static_cast<std::size_t>(cells_x + 1) +
                    static_cast<std::size_t>(column)];
  };
  const bool upper = fx >= fy;
  const double of_last = upper ? fy : fx;
  const double of_side = upper ? fx - fy : fy - fx;
  return mixed(at(i, j), 1.0 - of_last - of_side, upper ? at(i + 1, j) : at(i, j + 1), of_side, at(i + 1, j + 1),
               of_last);
}

Result<WarpMesh> make_warp_mesh(const ProjectorMap& map, const PictureShape& picture, double tolerance_px,
                                int max_cells) {
  TRY(validate(picture));
  const Pinhole& lens = map.lens();
  std::vector<Eigen::Hyperplane<double, 2>> creases = map.creases();
  if (creases.size() > kMaxLines) creases.resize(kMaxLines);
  const auto meshed = [&](int cells_x, int cells_y) {
    WarpMesh mesh = sampled(map, picture, creases, std::min(cells_x, lens.width_px), std::min(cells_y, lens.height_px));
    mesh.worst_error_px = worst_error(map, mesh, picture);
    return mesh;
  };
  WarpMesh mesh = meshed(kMinCells, kMinCells);
  while (!(mesh.worst_error_px <= tolerance_px)) {
    if ((mesh.cells_x == lens.width_px && mesh.cells_y == lens.height_px) ||
        2 * mesh.cells_x * mesh.cells_y > max_cells) {
      return Error(
          ErrorCode::kInvalidArgument,
          fmt::format("no warp mesh holds {} px (the finest is off by {:.2f} px): the projector is too near the wall, "
                      "meets it at a grazing angle, or sees one part of it behind another; move it",
                      tolerance_px, mesh.worst_error_px));
    }
    // Halves the cells in the direction that gains more: a cylinder bends horizontally and is nearly straight
    // vertically.
    WarpMesh narrower = meshed(2 * mesh.cells_x, mesh.cells_y);
    WarpMesh flatter = meshed(mesh.cells_x, 2 * mesh.cells_y);
    const bool is_wide = mesh.cells_x < lens.width_px;
    const bool is_high = mesh.cells_y < lens.height_px;
    // If both gain alike, halves the longer side, since graphics cards are slow with slivers.
    const bool is_broad = lens.width_px * mesh.cells_y >= lens.height_px * mesh.cells_x;
    const double favour = is_broad ? kAlike : 1.0 / kAlike;
    const bool across = is_wide && (!is_high || narrower.worst_error_px <= favour * flatter.worst_error_px);
    mesh = across ? std::move(narrower) : std::move(flatter);
  }
  return mesh;
}

}  // namespace cyclorama::warp
