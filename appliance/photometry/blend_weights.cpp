// SPDX-License-Identifier: Apache-2.0
#include "appliance/photometry/blend_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "appliance/calibration/map_grid.h"

namespace cyclorama::photometry {
namespace {

constexpr double kFeather_px = 96.0;  // Width of the fade at a map's end inside another projector's picture.
constexpr double kDeep_px = 48.0;     // A point this far inside a map is certainly covered by it.
constexpr double kMinWeight = 1e-6;   // Lower bound, so that the sum of weights is never 0.
// A side fades only if another picture extends beyond it by this much. Two nearly coincident sides cross many times
// because of the maps' noise, and the weights would nearly jump at each crossing on the rim of the lit area.
constexpr double kBeyond_px = 2.0;
constexpr double kStep_px = 4.0;  // Step along a side.
constexpr int kHalvings = 20;

double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Computes the distance in pixels from each control point to the nearest control point with distance 0, by two sweeps.
/// Source: Borgefors, "Distance transformations in digital images", CVGIP 34 (3), 1986.
void spread(const calibration::MapGrid& grid, std::vector<double>* distances) {
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

bool borders_on_nothing(const calibration::MeasuredMap& map, const calibration::MapGrid& grid, int x, int y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || x + dx > map.cells_x || y + dy < 0 || y + dy > map.cells_y) continue;
      if (!map.directions[static_cast<std::size_t>(grid.node(x + dx, y + dy))].allFinite()) return true;
    }
  }
  return false;
}

double interpolated(const std::vector<double>& values, const calibration::MapGrid& grid, const Eigen::Vector2d& pixel) {
  const auto weights = grid.weights_at(pixel);
  if (!weights) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    sum += weights->factors.at(i) * values[static_cast<std::size_t>(weights->nodes.at(i))];
  return sum;
}

/// Returns t (2 - t), where t is the distance from the stretches relative to `radius_px`, at most 1.
template <typename Stretches>
double risen(const Stretches& stretches, const Eigen::Vector2d& pixel, double radius_px) {
  double min = radius_px;
  for (const auto& stretch : stretches) {
    const Eigen::Vector2d along = stretch.to - stretch.from;
    const double length = std::max(along.squaredNorm(), 1e-12);  // The stretch may be a point.
    const double part = std::clamp((pixel - stretch.from).dot(along) / length, 0.0, 1.0);
    min = std::min(min, (pixel - stretch.from - part * along).norm());
  }
  const double t = min / radius_px;
  return t * (2.0 - t);
}

}  // namespace

BlendWeights::BlendWeights(const std::vector<PhotometricProjector>& projectors, const std::vector<InverseMap>& inverses)
    : inverses_(inverses) {
  for (const PhotometricProjector& projector : projectors) {
    const calibration::MeasuredMap& map = projector.map;
    pictures_.push_back({map.width_px, map.height_px, map.cells_x, map.cells_y, {}, {}});
  }
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const calibration::MeasuredMap& map = projectors[p].map;
    const Eigen::Vector2d right(map.width_px, 0.0);
    const Eigen::Vector2d low(0.0, map.height_px);
    pictures_[p].sides = {covered(p, map, {Eigen::Vector2d::Zero(), right}), covered(p, map, {low, low + right}),
                          covered(p, map, {Eigen::Vector2d::Zero(), low}), covered(p, map, {right, right + low})};
  }
  find_inner_ends(projectors);
}

bool BlendWeights::is_on_another(std::size_t picture, const calibration::MeasuredMap& map,
                                 const Eigen::Vector2d& pixel) const {
  const auto direction = map.direction_at(pixel);
  if (!direction) return false;
  for (std::size_t other = 0; other < pictures_.size(); ++other) {
    if (other == picture) continue;
    const auto theirs = inverses_[other].pixel_at(*direction);
    if (!theirs) continue;
    const Eigen::Vector2d size(pictures_[other].width_px, pictures_[other].height_px);
    if (std::min(theirs->minCoeff(), (size - *theirs).minCoeff()) > kBeyond_px) return true;
  }
  return false;
}

std::vector<BlendWeights::Stretch> BlendWeights::covered(std::size_t picture, const calibration::MeasuredMap& map,
                                                         const Stretch& side) const {
  const Eigen::Vector2d along = side.to - side.from;
  const auto position = [&](double part) -> Eigen::Vector2d { return side.from + part * along; };
  const int steps = std::max(2, static_cast<int>(along.norm() / kStep_px));
  std::vector<Stretch> stretches;
  bool was_on = false;
  for (int i = 0; i <= steps; ++i) {
    const double here = static_cast<double>(i) / steps;
    const bool is_on = is_on_another(picture, map, position(here));
    if (is_on != was_on) {
      // The stretch begins or ends between the previous step and this one, or at the side's beginning.
      double low = i == 0 ? here : static_cast<double>(i - 1) / steps;
      double high = here;
      for (int halving = 0; halving < kHalvings && low < high; ++halving) {
        const double middle = 0.5 * (low + high);
        (is_on_another(picture, map, position(middle)) == was_on ? low : high) = middle;
      }
      if (is_on) stretches.push_back({position(high), side.to});
      if (!is_on) stretches.back().to = position(low);
    }
    was_on = is_on;
  }
  return stretches;
}

/// Computes the distance of each control point from the ends of its map that lie deep inside another map.
void BlendWeights::find_inner_ends(const std::vector<PhotometricProjector>& projectors) {
  std::vector<std::vector<double>> any_end;
  constexpr double kFar_px = 1e5;
  for (const PhotometricProjector& projector : projectors) {
    const calibration::MeasuredMap& map = projector.map;
    const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
    auto& distances = any_end.emplace_back(static_cast<std::size_t>(grid.nodes()), kFar_px);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (!map.directions[i].allFinite()) distances[i] = 0.0;
    }
    spread(grid, &distances);
  }
  for (std::size_t p = 0; p < projectors.size(); ++p) {
    const calibration::MeasuredMap& map = projectors[p].map;
    const calibration::MapGrid grid{map.width_px, map.height_px, map.cells_x, map.cells_y};
    std::vector<double> distances(static_cast<std::size_t>(grid.nodes()), kFar_px);
    for (int y = 0; y <= map.cells_y; ++y) {
      for (int x = 0; x <= map.cells_x; ++x) {
        const auto node = static_cast<std::size_t>(grid.node(x, y));
        const Eigen::Vector3d& direction = map.directions[node];
        if (!direction.allFinite() || !borders_on_nothing(map, grid, x, y)) continue;
        for (std::size_t other = 0; other < projectors.size(); ++other) {
          if (other == p) continue;
          const auto pixel = inverses_[other].pixel_at(direction);
          const calibration::MeasuredMap& theirs = projectors[other].map;
          const calibration::MapGrid their_grid{theirs.width_px, theirs.height_px, theirs.cells_x, theirs.cells_y};
          if (pixel && interpolated(any_end[other], their_grid, *pixel) > kDeep_px) distances[node] = 0.0;
        }
      }
    }
    spread(grid, &distances);
    pictures_[p].inward_px = std::move(distances);
  }
}

double BlendWeights::inwardness(const Picture& picture, const Eigen::Vector2d& pixel) const {
  double rim = 1.0;
  for (std::size_t side = 0; side < picture.sides.size(); ++side)
    rim *= risen(picture.sides.at(side), pixel, 0.5 * (side < 2 ? picture.height_px : picture.width_px));
  const calibration::MapGrid grid{picture.width_px, picture.height_px, picture.cells_x, picture.cells_y};
  const double from_end = smooth_step(interpolated(picture.inward_px, grid, pixel) / kFeather_px);
  return rim * rim * std::max(kMinWeight, from_end);
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

}  // namespace cyclorama::photometry
