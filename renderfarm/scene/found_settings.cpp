// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "renderfarm/scene/environment_file.h"
#include "renderfarm/scene/ground.h"
#include "renderfarm/scene/space_grid.h"

namespace cyclorama::scene {
namespace {

constexpr double kEyeHeightM = 1.6;
constexpr double kMinPlaceM = 2.2;  ///< In all three directions; a smaller model is an object.
constexpr double kMinSiteM = 6.0;
constexpr int kDirections = 32;

/// Direction of a heading: 0 looks along -z, positive turns to the right.
Eigen::Vector3d ahead(double heading_rad) { return {std::sin(heading_rad), 0.0, -std::cos(heading_rad)}; }

double heading_of(int direction) { return 2.0 * std::numbers::pi * direction / kDirections; }

/// A standing position and what is visible from it.
struct Place {
  Standing standing;
  int walls = 0;  ///< Number of the kDirections rays that hit something.
  int from_behind = 0;
  bool has_ceiling = false;
  double ceiling_m = 0.0;  ///< Height above the eye.
  double nearest_m = 0.0;
  double mean_m = 0.0;
  double view_heading_rad = 0.0;  ///< Heading of the longest view.

  [[nodiscard]] bool is_inside_solid() const { return 2 * from_behind > walls; }
  [[nodiscard]] bool is_room() const { return has_ceiling && 4 * walls >= 3 * kDirections && !is_inside_solid(); }
  /// Prefers wide places, and long views among them.
  [[nodiscard]] double score() const { return std::min(nearest_m, 3.0) + 0.1 * std::min(mean_m, 15.0); }
};

Place look_around(const SpaceGrid& grid, const Standing& standing) {
  const Eigen::Vector3d& eye = standing.eye;
  Place place{.standing = standing};
  const SpaceGrid::Ray up = grid.cast(eye, Eigen::Vector3d::UnitY());
  place.has_ceiling = up.hits;
  place.ceiling_m = up.length_m;
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
    double view = 0.0;  // Spans some 50 degrees, so that a gap between two objects does not count as a view.
    for (int k = -2; k <= 2; ++k) view += lengths[static_cast<std::size_t>((i + k + kDirections) % kDirections)];
    if (view > best_view) {
      best_view = view;
      place.view_heading_rad = heading_of(i);
    }
  }
  return place;
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

struct BestPlaces {
  std::optional<Place> room;
  std::optional<Place> site;
};

BestPlaces find_places(const SpaceGrid& grid) {
  BestPlaces best;
  for_each_place(grid, [&](const Place& place) {
    if (place.is_inside_solid()) return;
    std::optional<Place>& same_kind = place.is_room() ? best.room : best.site;
    if (!same_kind || place.score() > same_kind->score()) same_kind = place;
  });
  return best;
}

/// Finds the floor below an eye that was chosen by somebody.
Standing stand_at(const SpaceGrid& grid, const Eigen::Vector3d& eye) {
  const SpaceGrid::Ray down = grid.cast(eye, -Eigen::Vector3d::UnitY());
  Standing standing{eye, eye.y() - kEyeHeightM};
  if (down.hits && down.length_m < 3.0 * kEyeHeightM) {
    const double floor = grid.top_of(grid.cell_of(eye - down.length_m * Eigen::Vector3d::UnitY()));
    if (floor < eye.y() - 0.3) standing.floor = floor;
  }
  return standing;
}

std::vector<Eigen::Vector2d> square_around(const Eigen::Vector3d& eye, double half_side) {
  const double x = eye.x();
  const double z = eye.z();
  return {{x - half_side, z - half_side},
          {x + half_side, z - half_side},
          {x + half_side, z + half_side},
          {x - half_side, z + half_side}};
}

/// A ring around the object, cut open behind it, because a walkable area has one outline.
std::vector<Eigen::Vector2d> ring(const Eigen::Vector3d& middle, double inner, double outer) {
  constexpr int kCorners = 32;
  std::vector<Eigen::Vector2d> corners;
  const auto add = [&](double radius, int i) {
    const Eigen::Vector3d direction = ahead(2.0 * std::numbers::pi * i / kCorners);
    corners.emplace_back(middle.x() + radius * direction.x(), middle.z() + radius * direction.z());
  };
  for (int i = 0; i <= kCorners; ++i) add(outer, i);
  for (int i = kCorners; i >= 0; --i) add(inner, i);
  return corners;
}

FoundSettings before_object(const Eigen::AlignedBox3d& bounds, const std::optional<Eigen::Vector3d>& eye) {
  // Keeps the object between tangents of -0.5 and 0.3: a wall 2.6 m high, 3 m away.
  constexpr double kDistanceByHeight = 1.3;
  constexpr double kDistanceByWidth = 0.8;
  // For an object of human height, so that steps there have their usual length.
  constexpr double kUsualDistanceM = 2.5;
  const Eigen::Vector3d size = bounds.sizes();
  const Eigen::Vector3d middle = bounds.center();
  const double distance =
      std::max({kDistanceByHeight * size.y(), kDistanceByWidth * size.x(), 0.1 * size.maxCoeff(), 1e-3});
  FoundSettings found;
  found.kind = SceneKind::kObject;
  found.eye = eye.value_or(Eigen::Vector3d(middle.x(), middle.y() + 0.1 * size.y(), bounds.max().z() + distance));
  found.eye_height_m = std::max(found.eye.y() - bounds.min().y(), 1e-3);
  found.walking_scale = std::clamp(distance / kUsualDistanceM, 1e-4, 1e4);
  found.view_m = distance;
  const double around = 0.5 * std::hypot(size.x(), size.z());
  const double eye_radius = std::hypot(found.eye.x() - middle.x(), found.eye.z() - middle.z());
  if (eye_radius > 0.1 * distance) {
    found.walkable = ring(middle, std::min(1.1 * around, 0.9 * eye_radius), std::max(around, eye_radius) + distance);
  } else {
    found.walkable = square_around(found.eye, distance);
  }
  return found;
}

FoundSettings standing_at(const SpaceGrid& grid, const Place& place, SceneKind kind) {
  FoundSettings found;
  found.kind = kind;
  found.eye = place.standing.eye;
  found.heading_rad = place.view_heading_rad;
  found.eye_height_m = place.standing.eye_height_m();
  found.walkable = walkable_outline(grid, place.standing);
  if (found.walkable.empty()) found.walkable = square_around(found.eye, 0.5);
  found.view_m = place.mean_m;
  found.ceiling_m = place.ceiling_m;
  found.free_m = std::min(place.nearest_m, 3.0);
  return found;
}

/// Irradiance from `light` on a surface at `p` that faces it.
Eigen::Vector3d irradiance(const Light& light, const Eigen::Vector3d& p) {
  const Eigen::Vector3d intensity = light.intensity.cast<double>();
  if (light.kind == LightKind::kDirectional) return intensity;
  const Eigen::Vector3d away = p - light.position;
  const double distance2 = std::max(away.squaredNorm(), 1e-4);
  if (light.range_m > 0.0 && distance2 > light.range_m * light.range_m) return Eigen::Vector3d::Zero();
  const double cosine = away.normalized().dot(light.direction);
  if (is_flat(light.kind)) {
    const double area = area_of(light);
    return intensity * (std::max(0.0, cosine) * area / (distance2 + area / std::numbers::pi));
  }
  if (light.kind == LightKind::kSpot && cosine < std::cos(light.outer_cone_rad)) return Eigen::Vector3d::Zero();
  return intensity / distance2;
}

}  // namespace

FoundSettings find_settings(const Model& model, const Eigen::AlignedBox3d& bounds,
                            const std::optional<Eigen::Vector3d>& eye) {
  const Eigen::Vector3d size = bounds.sizes();
  if (size.minCoeff() < kMinPlaceM && std::min(size.x(), size.z()) < kMinSiteM) return before_object(bounds, eye);
  const SpaceGrid grid(model, bounds);
  if (eye && bounds.contains(*eye)) {
    const Place place = look_around(grid, stand_at(grid, *eye));
    return standing_at(grid, place, place.is_room() ? SceneKind::kRoom : SceneKind::kSite);
  }
  if (eye) return before_object(bounds, eye);
  const BestPlaces best = find_places(grid);
  if (best.room) return standing_at(grid, *best.room, SceneKind::kRoom);
  // Where nothing rises to the eye's height, the surface may be the top of an object; only a plain is open everywhere.
  const double flatness = best.site && best.site->walls > 0 ? 0.7 : 2.0;
  const bool is_wide = std::min(size.x(), size.z()) >= std::max(kMinSiteM, flatness * size.y());
  if (best.site && is_wide) return standing_at(grid, *best.site, SceneKind::kSite);
  return before_object(bounds, std::nullopt);
}

void add_light(const FoundSettings& found, Scene* scene) {
  if (found.kind == SceneKind::kRoom) {
    const double reach = std::max(0.6 * found.view_m, 0.5);
    const auto candela = static_cast<float>(3.0 * reach * reach);
    scene->eye_lamp.setConstant(0.4f * candela);
    scene->ambient.setConstant(0.08f);
    // Keeps the lamp well below a low ceiling and limits its light there; otherwise the white spot above it would
    // dominate.
    constexpr double kMinDropM = 0.8;
    constexpr double kBrightestLux = 4.0;
    const double drop = std::max(0.5 * found.ceiling_m, kMinDropM);
    Light hanging;  // Gives shapes shadows, which a lamp at the eye does not.
    hanging.name = "hanging";
    hanging.position = found.eye + (found.ceiling_m - drop) * Eigen::Vector3d::UnitY() +
                       (0.5 * found.free_m) * ahead(found.heading_rad - 0.5 * std::numbers::pi);
    hanging.intensity.setConstant(std::min(0.6f * candela, static_cast<float>(kBrightestLux * drop * drop)));
    hanging.radius_m = std::min({0.1, 0.2 * found.ceiling_m, 0.2 * found.free_m});
    scene->model.lights.push_back(std::move(hanging));
    return;
  }
  scene->sky = {Eigen::Vector3f::Constant(0.45f), Eigen::Vector3f::Constant(0.2f), Eigen::Vector3f::Constant(0.1f)};
  Light key;  // From the visitor's upper left, as is usual in paintings.
  key.name = "key";
  key.kind = LightKind::kDirectional;
  key.direction = (0.5 * ahead(found.heading_rad + 0.5 * std::numbers::pi) + 0.6 * ahead(found.heading_rad) -
                   0.7 * Eigen::Vector3d::UnitY())
                      .normalized();
  key.intensity.setConstant(2.2f);
  key.radius_m = 0.05;
  scene->model.lights.push_back(std::move(key));
}

double find_exposure(const FoundSettings& found, const Scene& scene) {
  constexpr double kMiddle = 0.25;  // Radiance of a surface that reflects half of its light.
  constexpr int kSamples = 256;
  Eigen::Vector3d from_all_around = Eigen::Vector3d::Zero();
  if (scene.environment) from_all_around = std::numbers::pi * mean_radiance(*scene.environment).cast<double>();
  std::vector<double> levels;
  for (int i = 0; i < kSamples; ++i) {
    // Samples lie on a spiral around the eye, at the distances of walls and objects.
    const double angle = 2.399963 * i;
    const double distance = found.view_m * std::sqrt((i + 0.5) / kSamples);
    const double height = (i % 5 - 2) * 0.2 * std::min(found.view_m, 3.0);
    const Eigen::Vector3d p = found.eye + distance * ahead(angle) + height * Eigen::Vector3d::UnitY();
    Eigen::Vector3d sum = from_all_around;
    // Half of the irradiance on a surface facing the light.
    for (const Light& light : scene.model.lights) sum += 0.5 * irradiance(light, p);
    levels.push_back(sum.dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)));
  }
  std::nth_element(levels.begin(), levels.begin() + kSamples / 2, levels.end());
  const double radiance = 0.5 * levels[kSamples / 2] / std::numbers::pi;
  if (!(radiance > 1e-9)) return 1.0;
  return std::clamp(kMiddle / radiance, 1e-6, 1e6);
}

}  // namespace cyclorama::scene
