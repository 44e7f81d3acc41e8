// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibration/measured_map.h"

#include <cmath>
#include <limits>

#include "appliance/calibration/map_grid.h"

namespace cyclorama::calibration {

std::optional<Eigen::Vector3d> MeasuredMap::direction_at(const Eigen::Vector2d& pixel) const {
  const MapGrid grid{width_px, height_px, cells_x, cells_y};
  const auto weights = grid.weights_at(pixel);
  if (!weights) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t a = 0; a < 3; ++a) {
    if (weights->factors[a] != 0.0)
      sum += weights->factors[a] * directions[static_cast<std::size_t>(weights->nodes[a])];
  }
  if (!(sum.norm() > 1e-6)) return std::nullopt;
  return sum.normalized();
}

double MeasuredMap::sigma_at(const Eigen::Vector2d& pixel) const {
  const MapGrid grid{width_px, height_px, cells_x, cells_y};
  const auto weights = grid.weights_at(pixel);
  if (!weights || !direction_at(pixel)) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (weights->factors[a] != 0.0) sum += weights->factors[a] * sigma_px[static_cast<std::size_t>(weights->nodes[a])];
  }
  return sum;
}

Result<warp::Warp> warp_of(const MeasuredMap& map, const PictureShape& picture) {
  TRY(validate(picture));
  warp::WarpMesh mesh;
  mesh.width_px = map.width_px;
  mesh.height_px = map.height_px;
  mesh.cells_x = map.cells_x;
  mesh.cells_y = map.cells_y;
  const MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& d : map.directions) {
    if (d.allFinite()) middle += d;
  }
  const double middle_rad = std::atan2(middle.x(), -middle.z());
  bool is_any = false;
  for (int y = 0; y <= map.cells_y; ++y) {
    for (int x = 0; x <= map.cells_x; ++x) {
      warp::WarpVertex vertex;
      vertex.x_px = static_cast<float>(x * grid.cell_width());
      vertex.y_px = static_cast<float>(y * grid.cell_height());
      vertex.azimuth_rad = vertex.tan_elevation = std::numeric_limits<float>::quiet_NaN();
      const Eigen::Vector3d& d = map.directions[static_cast<std::size_t>(grid.node(x, y))];
      const auto position = d.allFinite() ? place_of(picture, d) : std::nullopt;
      if (position) {
        const PicturePlace near = warp::counted_near(*position, picture, middle_rad);
        vertex.azimuth_rad = static_cast<float>(near.across);
        vertex.tan_elevation = static_cast<float>(near.up);
        is_any = true;
      }
      mesh.vertices.push_back(vertex);
    }
  }
  if (!is_any) return Error(ErrorCode::kBadData, "nothing of the map lies in the picture; choose another picture");
  // Converts the map's error, for which left-out cells give the best estimate, to picture pixels at the map's middle.
  double radians_per_px = 0.0;
  for (int x = 0, y = map.cells_y / 2; x < map.cells_x; ++x) {
    const Eigen::Vector3d& a = map.directions[static_cast<std::size_t>(grid.node(x, y))];
    const Eigen::Vector3d& b = map.directions[static_cast<std::size_t>(grid.node(x + 1, y))];
    if (!a.allFinite() || !b.allFinite()) continue;
    const auto pa = place_of(picture, a);
    const auto pb = place_of(picture, b);
    if (!pa || !pb) continue;
    radians_per_px =
        std::max(radians_per_px, pixel_scale(picture).distance_px(warp::counted_near(*pa, picture, middle_rad),
                                                                  warp::counted_near(*pb, picture, middle_rad)) /
                                     grid.cell_width());
  }
  mesh.worst_error_px = map.heldout_rms_px * radians_per_px;
  return warp::Warp(std::move(mesh));
}

}  // namespace cyclorama::calibration
