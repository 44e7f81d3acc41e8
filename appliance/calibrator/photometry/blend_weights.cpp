// SPDX-License-Identifier: Apache-2.0
#include "appliance/calibrator/photometry/blend_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "appliance/calibrator/solve/map_grid.h"

namespace cyclorama {
namespace {

constexpr double kFeather_px = 96.0;  // Of a map's end inside of another projector's picture.
constexpr double kDeep_px = 48.0;     // A place so far inside of its map is surely that projector's.
constexpr double kLeast = 1e-6;       // Weights never lose everybody.

double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// From each control point to the nearest that `is_far` of 0, in pixels, by two sweeps over neighbours.
/// Source: Borgefors, "Distance transformations in digital images", CVGIP 34 (3), 1986.
void spread(const MapGrid& grid, std::vector<double>* distances) {
  const double across = grid.cell_width();
  const double down = grid.cell_height();
  const double diagonal = std::hypot(across, down);
  const auto relax = [&](int x, int y, int dx, int dy, double length) {
    if (x + dx < 0 || x + dx > grid.cells_x || y + dy < 0 || y + dy > grid.cells_y) return;
    double& here = (*distances)[static_cast<std::size_t>(grid.node(x, y))];
    here = std::min(here, (*distances)[static_cast<std::size_t>(grid.node(x + dx, y + dy))] + length);
  };
  for (int y = 0; y <= grid.cells_y; ++y) {
    for (int x = 0; x <= grid.cells_x; ++x) {
      relax(x, y, -1, 0, across);
      relax(x, y, 0, -1, down);
      relax(x, y, -1, -1, diagonal);
      relax(x, y, 1, -1, diagonal);
    }
  }
  for (int y = grid.cells_y; y >= 0; --y) {
    for (int x = grid.cells_x; x >= 0; --x) {
      relax(x, y, 1, 0, across);
      relax(x, y, 0, 1, down);
      relax(x, y, 1, 1, diagonal);
      relax(x, y, -1, 1, diagonal);
    }
  }
}

bool borders_on_nothing(const MeasuredMap& map, const MapGrid& grid, int x, int y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || x + dx > map.cells_x || y + dy < 0 || y + dy > map.cells_y) continue;
      if (!map.directions[static_cast<std::size_t>(grid.node(x + dx, y + dy))].allFinite()) return true;
    }
  }
  return false;
}

double interpolated(const std::vector<double>& values, const MapGrid& grid, const Eigen::Vector2d& pixel) {
  const auto weights = grid.weights_at(pixel);
  if (!weights) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    sum += weights->factors.at(i) * values[static_cast<std::size_t>(weights->nodes.at(i))];
  return sum;
}

}  // namespace

BlendWeights::BlendWeights(const std::vector<PhotometricProjector>& projectors, const std::vector<InverseMap>& inverses)
    : inverses_(inverses) {
  // First: how far from any end of its map. Then ends that lie deep inside of another's map are where to fade.
  std::vector<std::vector<double>> any_end;
  constexpr double kFar_px = 1e5;
  for (const PhotometricProjector& projector : projectors) {
    const MeasuredMap& map = projector.map;
    const MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
    pictures_.push_back({map.width_px, map.height_px, map.cells_x, map.cells_y, {}});
    auto& distances = any_end.emplace_back(static_cast<std::size_t>(grid.nodes()), kFar_px);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (!map.directions[i].allFinite()) distances[i] = 0.0;
    }
    spread(grid, &distances);
  }
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const MeasuredMap& map = projectors[p].map;
    const MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
    std::vector<double> distances(static_cast<std::size_t>(grid.nodes()), kFar_px);
    for (int y = 0; y <= map.cells_y; ++y) {
      for (int x = 0; x <= map.cells_x; ++x) {
        const auto node = static_cast<std::size_t>(grid.node(x, y));
        const Eigen::Vector3d& direction = map.directions[node];
        if (!direction.allFinite() || !borders_on_nothing(map, grid, x, y)) continue;
        for (std::size_t other = 0; other < projectors.size(); ++other) {
          if (other == p) continue;
          const auto pixel = inverses_[other].pixel_at(direction);
          const MeasuredMap& theirs = projectors[other].map;
          const MapGrid their_grid{theirs.width_px, theirs.height_px, theirs.cells_x, theirs.cells_y};
          if (pixel && interpolated(any_end[other], their_grid, *pixel) > kDeep_px) distances[node] = 0.0;
        }
      }
    }
    spread(grid, &distances);
    pictures_[p].inward_px = std::move(distances);
  }
}

double BlendWeights::inwardness(const Picture& picture, const Eigen::Vector2d& pixel) const {
  const double w = picture.width_px;
  const double h = picture.height_px;
  const double inward = 16.0 * pixel.x() * (w - pixel.x()) * pixel.y() * (h - pixel.y()) / (w * w * h * h);
  const MapGrid grid{picture.width_px, picture.height_px, picture.cells_x, picture.cells_y};
  const double from_end = smooth_step(interpolated(picture.inward_px, grid, pixel) / kFeather_px);
  const double rim = std::max(0.0, inward);
  return rim * rim * std::max(kLeast, from_end);
}

std::vector<BlendWeights::Share> BlendWeights::at(const Eigen::Vector3d& direction) const {
  return at(direction, pictures_.size(), Eigen::Vector2d::Zero());
}

std::vector<BlendWeights::Share> BlendWeights::at(const Eigen::Vector3d& direction, std::size_t projector,
                                                  const Eigen::Vector2d& own) const {
  std::vector<Share> shares;
  double sum = 0.0;
  for (std::size_t p = 0; p < pictures_.size(); ++p) {
    const auto pixel = p == projector ? std::optional(own) : inverses_[p].pixel_at(direction);
    if (!pixel) continue;
    shares.push_back({p, *pixel, std::max(inwardness(pictures_[p], *pixel), 1e-30)});
    sum += shares.back().weight;
  }
  for (Share& share : shares) share.weight /= sum;
  return shares;
}

}  // namespace cyclorama
