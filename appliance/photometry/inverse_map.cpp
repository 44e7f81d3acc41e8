// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/inverse_map.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "appliance/calibration/map_grid.h"

namespace cyclorama::photometry {
namespace {

constexpr double kMaxBins = 4e5;
/// A chart bends lines, so a triangle may exceed the bounding box of its corners by this fraction of the box's size.
constexpr double kBulge = 0.05;
constexpr double kOnEdge = 1e-9;

struct Seen {
  Eigen::Vector3d direction;
};

}  // namespace

Result<InverseMap> InverseMap::make(const calibration::MeasuredMap& map) {
  const auto nodes = static_cast<std::size_t>(map.cells_x + 1) * static_cast<std::size_t>(map.cells_y + 1);
  if (map.cells_x < 1 || map.cells_y < 1 || map.width_px < 1 || map.height_px < 1 || map.directions.size() != nodes)
    return Error(ErrorCode::kInvalidArgument, "a map whose counts do not go together; measure it again");
  std::vector<Seen> seen;
  for (const Eigen::Vector3d& d : map.directions) {
    if (d.allFinite()) seen.push_back({d});
  }
  if (seen.empty())
    return Error(ErrorCode::kInvalidArgument, "a map without directions; let the camera see the projector's picture");
  const auto chart = calibration::DirectionChart::around(seen);
  if (!chart) {
    return Error(ErrorCode::kInvalidArgument,
                 "a map that goes round the sweet spot; one projector lights less than a whole turn");
  }
  return InverseMap(map, *chart);
}

InverseMap::InverseMap(const calibration::MeasuredMap& map, const calibration::DirectionChart& chart) : chart_(chart) {
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);
  low_ = Eigen::Vector2d::Constant(1e9);
  for (const Eigen::Vector3d& d : map.directions) {
    if (!d.allFinite()) continue;
    const auto position = chart_.place_of(d);
    if (!position) continue;
    low_ = low_.cwiseMin(*position);
    high = high.cwiseMax(*position);
  }
  const Eigen::Vector2d size = (high - low_).cwiseMax(1e-6);
  const double wanted = std::min(kMaxBins, static_cast<double>(map.cells_x) * map.cells_y);
  bins_per_rad_ = std::sqrt(wanted / (size.x() * size.y()));
  columns_ = std::clamp(static_cast<int>(size.x() * bins_per_rad_) + 1, 1, static_cast<int>(kMaxBins));
  rows_ = std::clamp(static_cast<int>(size.y() * bins_per_rad_) + 1, 1, static_cast<int>(kMaxBins));
  if (static_cast<double>(columns_) * rows_ > 4.0 * kMaxBins) {
    // The map is nearly a line, so larger bins suffice.
    bins_per_rad_ = 1000.0 / size.maxCoeff();
    columns_ = static_cast<int>(size.x() * bins_per_rad_) + 1;
    rows_ = static_cast<int>(size.y() * bins_per_rad_) + 1;
  }
  bins_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
  for (int y = 0; y < map.cells_y; ++y) {
    for (int x = 0; x < map.cells_x; ++x) {
      const int at = grid.node(x, y);
      const int below = grid.node(x, y + 1);
      add(map, {at, at + 1, below + 1});
      add(map, {at, below, below + 1});
    }
  }
}

Eigen::Vector2i InverseMap::bin_of(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d at = (position - low_) * bins_per_rad_;
  return {static_cast<int>(std::clamp(std::floor(at.x()), -1.0, static_cast<double>(columns_))),
          static_cast<int>(std::clamp(std::floor(at.y()), -1.0, static_cast<double>(rows_)))};
}

void InverseMap::add(const calibration::MeasuredMap& map, const std::array<int, 3>& nodes) {
  const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
  Eigen::Matrix3d directions;
  Triangle triangle;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e9);
  for (int i = 0; i < 3; ++i) {
    const int node = nodes.at(static_cast<std::size_t>(i));
    const Eigen::Vector3d& d = map.directions[static_cast<std::size_t>(node)];
    if (!d.allFinite()) return;
    const auto position = chart_.place_of(d);
    if (!position) return;
    directions.col(i) = d;
    triangle.corners_px.col(i) = Eigen::Vector2d((node % (map.cells_x + 1)) * grid.cell_width(),
                                                 (node / (map.cells_x + 1)) * grid.cell_height());
    low = low.cwiseMin(*position);
    high = high.cwiseMax(*position);
  }
  const Eigen::Vector3d edge_a = directions.col(1) - directions.col(0);
  const Eigen::Vector3d edge_b = directions.col(2) - directions.col(0);
  if (!(std::abs(directions.determinant()) > 1e-9 * edge_a.norm() * edge_b.norm())) return;
  triangle.shares = directions.inverse();
  const double bulge = kBulge * (high - low).maxCoeff();
  const Eigen::Vector2i first = bin_of(low - Eigen::Vector2d::Constant(bulge)).cwiseMax(0);
  const Eigen::Vector2i last =
      bin_of(high + Eigen::Vector2d::Constant(bulge)).cwiseMin(Eigen::Vector2i(columns_ - 1, rows_ - 1));
  const int index = static_cast<int>(triangles_.size());
  triangles_.push_back(triangle);
  for (int y = first.y(); y <= last.y(); ++y) {
    for (int x = first.x(); x <= last.x(); ++x)
      bins_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)].push_back(
          index);
  }
}

std::optional<Eigen::Vector2d> InverseMap::pixel_at(const Eigen::Vector3d& direction) const {
  const auto position = chart_.place_of(direction);
  if (!position) return std::nullopt;
  const Eigen::Vector2i bin = bin_of(*position);
  if (bin.x() < 0 || bin.y() < 0 || bin.x() >= columns_ || bin.y() >= rows_) return std::nullopt;
  const auto& candidates =
      bins_[static_cast<std::size_t>(bin.y()) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(bin.x())];
  for (const int index : candidates) {
    const Triangle& triangle = triangles_[static_cast<std::size_t>(index)];
    const Eigen::Vector3d shares = triangle.shares * direction;
    const double sum = shares.sum();
    if (!(sum > 0.0) || !(shares.minCoeff() >= -kOnEdge * sum)) continue;
    return triangle.corners_px * (shares / sum);
  }
  return std::nullopt;
}

}  // namespace cyclorama::photometry
