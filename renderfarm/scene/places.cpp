// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace cyclorama::scene {
namespace {

constexpr int kDirections = Place::kDirections;
constexpr int kHalfPicture = 5;  ///< The picture spans 11 of 32 directions: 124 degrees.
/// Tangents of the elevation of the picture's rows, as on a wall, and of the direction to the ground before the
/// visitor's feet.
constexpr std::array<double, 5> kRows = {0.3, 0.15, 0.0, -0.15, -0.3};
constexpr double kFeet = -0.6;
constexpr double kStepM = 0.8;
constexpr double kFarM = 15.0;
constexpr std::size_t kPictured = 10;  ///< Candidates of each kind whose picture is traced.

double heading_of(int direction) { return 2.0 * std::numbers::pi * direction / kDirections; }

/// Returns a score that prefers open positions, those with something to see, and long views among these, for a first
/// selection before pictures are traced.
double roominess(const Place& place) {
  constexpr double kEnoughToSee = 0.25 * kDirections;
  return std::min(place.nearest_m, 3.0) + 0.1 * std::min(place.mean_m, kFarM) +
         0.5 * std::min(1.0, place.walls / kEnoughToSee);
}

/// Returns the eye, or a point above it if the eye is in a ground cell, because cells of a large site are higher than
/// people.
Eigen::Vector3d eye_above_ground(const SpaceGrid& grid, const Standing& standing) {
  const Eigen::Vector3i cell = grid.cell_of(standing.eye);
  if (!grid.is_solid(cell) || grid.is_solid(cell + Eigen::Vector3i::UnitY())) return standing.eye;
  const double y = grid.centre_of(cell + Eigen::Vector3i::UnitY()).y();
  return {standing.eye.x(), y, standing.eye.z()};
}

/// Sums over one column of the picture.
struct Column {
  double seen = 0.0;
  double near = 0.0;
  double depth_m = 0.0;
  double level_m = 0.0;  ///< Distance at the height of the eye.
};

Column column_of(const SpaceGrid& grid, const Eigen::Vector3d& eye, int direction) {
  Column column;
  for (const double tangent : kRows) {
    const Eigen::Vector3d ray = (ahead(heading_of(direction)) + tangent * Eigen::Vector3d::UnitY()).normalized();
    const SpaceGrid::Ray hit = grid.cast(eye, ray);
    if (tangent == 0.0) column.level_m = hit.length_m;
    if (!hit.hits || hit.from_behind) continue;
    column.seen += 1.0;
    column.near += hit.length_m < kStepM ? 1.0 : 0.0;
    column.depth_m += std::min(hit.length_m, kFarM);
  }
  return column;
}

/// Returns true if the surface in the middle column is not the plane of its neighbours' surfaces. Along a plane, the
/// inverse distance is a cosine of the direction.
bool is_edge(const SpaceGrid& grid, const Column& left, const Column& middle, const Column& right) {
  constexpr double kBend = 0.25;
  const double inverse = 1.0 / left.level_m + 1.0 / right.level_m - 2.0 / middle.level_m;
  return std::abs(inverse) * middle.level_m > kBend + grid.cell_m() / middle.level_m;
}

bool is_ground_ahead(const SpaceGrid& grid, const Standing& standing, int direction) {
  const Eigen::Vector3d ray = (ahead(heading_of(direction)) + kFeet * Eigen::Vector3d::UnitY()).normalized();
  const SpaceGrid::Ray hit = grid.cast(standing.eye, ray);
  // Finds ground that is at most half a step's length below the visitor's.
  return hit.hits && hit.length_m < std::hypot(1.0, 1.0 / kFeet) * (standing.eye_height_m() + 0.5 * kStepM);
}

/// Calls `use` for each place where a visitor could stand.
template <typename Use>
void for_each_place(const SpaceGrid& grid, const Use& use) {
  Eigen::Vector3i cell;
  for (cell.z() = 0; cell.z() < grid.cells().z(); cell.z() += 2) {
    for (cell.x() = 0; cell.x() < grid.cells().x(); cell.x() += 2) {
      for (cell.y() = 0; cell.y() < grid.cells().y(); ++cell.y()) {
        if (!grid.is_solid(cell) || grid.is_solid(cell + Eigen::Vector3i::UnitY())) continue;
        const Eigen::Vector3d centre = grid.centre_of(cell);
        const double floor = grid.top_of(cell);
        if (!body_fits(grid, centre.x(), centre.z(), floor, kEyeHeightM)) continue;
        use(look_around(grid, {{centre.x(), floor + kEyeHeightM, centre.z()}, floor}));
      }
    }
  }
}

/// Returns the roomiest places, spread over the scene: at most one from each block of cells and kMaxOfFloor from each
/// floor.
std::vector<Place> roomiest(std::vector<Place> places, const SpaceGrid& grid) {
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return roominess(a) > roominess(b); });
  const Eigen::Array3i block_cells(24, 4, 24);
  constexpr int kMaxOfFloor = 5;
  std::vector<Place> kept;
  std::vector<Eigen::Array3i> blocks;
  for (const Place& place : places) {
    const Eigen::Array3i block = grid.cell_of(place.standing.eye).array() / block_cells;
    const auto is_same = [&](const Eigen::Array3i& other) { return (other == block).all(); };
    const auto is_same_floor = [&](const Eigen::Array3i& other) { return other.y() == block.y(); };
    if (std::any_of(blocks.begin(), blocks.end(), is_same)) continue;
    if (std::count_if(blocks.begin(), blocks.end(), is_same_floor) >= kMaxOfFloor) continue;
    blocks.push_back(block);
    kept.push_back(place);
    if (kept.size() == kPictured) break;
  }
  return kept;
}

std::optional<Place> best_of(std::vector<Place> places, const SpaceGrid& grid) {
  std::vector<Place> candidates = roomiest(std::move(places), grid);
  std::vector<double> areas;
  areas.reserve(candidates.size());
  for (const Place& place : candidates) {
    areas.push_back(walkable_area_m2(grid, place.standing));
  }
  const double largest = std::max(1e-9, areas.empty() ? 0.0 : *std::max_element(areas.begin(), areas.end()));
  std::optional<Place> best;
  double best_score = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const PlaceView view = view_at(grid, candidates[i]);
    const double score = roominess(candidates[i]) + 3.0 * view.score() + 3.0 * std::sqrt(areas[i] / largest);
    if (score <= best_score) continue;
    best_score = score;
    best = candidates[i];
    best->view_heading_rad = view.heading_rad;
    best->walkable_m2 = areas[i];
  }
  return best;
}

}  // namespace

Eigen::Vector3d ahead(double heading_rad) { return {std::sin(heading_rad), 0.0, -std::cos(heading_rad)}; }

double PlaceView::score() const {
  constexpr double kUsualDepthM = 4.0;
  return seen - near + 0.5 * ground + 0.8 * (1.0 - std::exp(-depth_m / kUsualDepthM)) + 0.5 * edges;
}

Place look_around(const SpaceGrid& grid, const Standing& standing) {
  const Eigen::Vector3d eye = eye_above_ground(grid, standing);
  Place place{.standing = standing};
  const SpaceGrid::Ray up = grid.cast(eye, Eigen::Vector3d::UnitY());
  place.has_ceiling = up.hits;
  place.ceiling_m = up.length_m;
  constexpr double kMinCells = 3.0;
  place.is_resolved = up.length_m + standing.eye_height_m() >= kMinCells * grid.cell_m();
  place.nearest_m = std::numeric_limits<double>::infinity();
  std::array<double, kDirections> lengths{};
  for (int i = 0; i < kDirections; ++i) {
    const SpaceGrid::Ray ray = grid.cast(eye, ahead(heading_of(i)));
    place.walls += ray.hits ? 1 : 0;
    place.from_behind += ray.hits && ray.from_behind ? 1 : 0;
    place.nearest_m = std::min(place.nearest_m, ray.length_m);
    place.mean_m += ray.length_m / kDirections;
    lengths[static_cast<std::size_t>(i)] = ray.length_m;
  }
  double best_view = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    double view = 0.0;  // Spans about 50 degrees, so that a gap between two objects does not count as a view.
    for (int k = -2; k <= 2; ++k) view += lengths[static_cast<std::size_t>((i + k + kDirections) % kDirections)];
    if (view > best_view) {
      best_view = view;
      place.view_heading_rad = heading_of(i);
    }
  }
  return place;
}

PlaceView view_at(const SpaceGrid& grid, const Place& place) {
  const Eigen::Vector3d eye = eye_above_ground(grid, place.standing);
  std::array<Column, kDirections> columns;
  PlaceView best;
  for (int i = 0; i < kDirections; ++i) {
    columns[static_cast<std::size_t>(i)] = column_of(grid, eye, i);
    best.ground += is_ground_ahead(grid, place.standing, i) ? 1.0 / kDirections : 0.0;
  }
  constexpr double kRays = (2.0 * kHalfPicture + 1.0) * static_cast<double>(kRows.size());
  double best_score = -std::numeric_limits<double>::infinity();
  const auto at = [&](int i) -> const Column& {
    return columns[static_cast<std::size_t>((i + kDirections) % kDirections)];
  };
  for (int i = 0; i < kDirections; ++i) {
    Column sum;
    double edges = 0.0;
    for (int k = -kHalfPicture; k <= kHalfPicture; ++k) {
      const Column& column = at(i + k);
      edges += is_edge(grid, at(i + k - 1), column, at(i + k + 1)) ? 1.0 : 0.0;
      sum.seen += column.seen;
      sum.near += column.near;
      sum.depth_m += column.depth_m;
    }
    PlaceView view = best;
    view.heading_rad = heading_of(i);
    view.seen = sum.seen / kRays;
    view.near = sum.near / kRays;
    view.depth_m = sum.depth_m / kRays;
    view.edges = edges / (2.0 * kHalfPicture + 1.0);
    if (view.score() <= best_score) continue;
    best_score = view.score();
    best = view;
  }
  return best;
}

BestPlaces find_places(const SpaceGrid& grid) {
  std::vector<Place> rooms;
  std::vector<Place> sites;
  for_each_place(grid, [&](const Place& place) {
    if (place.is_inside_solid() || place.is_inside_vessel()) return;
    (place.is_room() ? rooms : sites).push_back(place);
  });
  return {best_of(std::move(rooms), grid), best_of(std::move(sites), grid)};
}

}  // namespace cyclorama::scene
