// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "renderfarm/scene/facings.h"
#include "renderfarm/scene/places.h"

namespace cyclorama::scene {
namespace {

constexpr double kMinPlaceM = 2.2;  ///< Minimum extent in all three directions; a smaller model is an object.
constexpr double kMinSiteM = 6.0;
constexpr double kMuchGroundM2 = 100.0;
/// Maximum height of a room without a ceiling; anything higher is taken as a hollow object in another unit.
constexpr double kMaxCourtM = 8.0;

/// Finds the floor below a given eye.
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

/// Returns a ring around the object. The ring is cut open behind the object, because a walkable area has one outline.
std::vector<Eigen::Vector2d> ring(const Eigen::Vector3d& middle, double heading_rad, double inner, double outer) {
  constexpr int kCorners = 32;
  std::vector<Eigen::Vector2d> corners;
  const auto add = [&](double radius, int i) {
    const Eigen::Vector3d direction = ahead(heading_rad + 2.0 * std::numbers::pi * i / kCorners);
    corners.emplace_back(middle.x() + radius * direction.x(), middle.z() + radius * direction.z());
  };
  for (int i = 0; i <= kCorners; ++i) add(outer, i);
  for (int i = kCorners; i >= 0; --i) add(inner, i);
  return corners;
}

/// Returns the heading from which most of an object is visible. The visitor stands on the side of +z, which is the
/// front in glTF, unless the object is flat and shows an edge or its back on that side.
double heading_before(const Model& model, const Eigen::Vector3d& size) {
  constexpr double kFlat = 0.3;
  const bool is_edge_on = size.x() < kFlat * size.z();
  if (!is_edge_on && size.z() >= kFlat * size.x()) return 0.0;
  const bool shows_back = facings_of(model).shows_back(is_edge_on ? 0 : 2);
  if (!is_edge_on) return shows_back ? std::numbers::pi : 0.0;
  return shows_back ? 0.5 * std::numbers::pi : -0.5 * std::numbers::pi;
}

FoundSettings before_object(const Model& model, const Eigen::AlignedBox3d& bounds,
                            const std::optional<Eigen::Vector3d>& eye) {
  // These distances keep the object between tangents of -0.5 and 0.3, as on a wall that is 2.6 m high and 3 m away.
  constexpr double kDistanceByHeight = 1.3;
  constexpr double kDistanceByWidth = 0.8;
  // Viewing distance of an object as tall as a person; steps have their usual length at this distance.
  constexpr double kUsualDistanceM = 2.5;
  const Eigen::Vector3d size = bounds.sizes();
  const Eigen::Vector3d middle = bounds.center();
  FoundSettings found;
  found.kind = SceneKind::kObject;
  if (!eye) found.heading_rad = heading_before(model, size);
  const Eigen::Vector3d back = -ahead(found.heading_rad);
  const bool is_along_z = std::abs(back.z()) > 0.5;
  const double width = is_along_z ? size.x() : size.z();
  const double depth = is_along_z ? size.z() : size.x();
  const double distance =
      std::max({kDistanceByHeight * size.y(), kDistanceByWidth * width, 0.1 * size.maxCoeff(), 1e-3});
  found.eye = eye.value_or(middle + 0.1 * size.y() * Eigen::Vector3d::UnitY() + (0.5 * depth + distance) * back);
  found.eye_height_m = std::max(found.eye.y() - bounds.min().y(), 1e-3);
  found.walking_scale = std::clamp(distance / kUsualDistanceM, 1e-4, 1e4);
  found.view_m = distance;
  const double around = 0.5 * std::hypot(size.x(), size.z());
  const double eye_radius = std::hypot(found.eye.x() - middle.x(), found.eye.z() - middle.z());
  if (eye_radius > 0.1 * distance) {
    found.walkable = ring(middle, found.heading_rad, std::min(1.1 * around, 0.9 * eye_radius),
                          std::max(around, eye_radius) + distance);
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

}  // namespace

FoundSettings find_settings(const Model& model, const Eigen::AlignedBox3d& bounds,
                            const std::optional<Eigen::Vector3d>& eye) {
  const Eigen::Vector3d size = bounds.sizes();
  if (size.minCoeff() < kMinPlaceM && std::min(size.x(), size.z()) < kMinSiteM)
    return before_object(model, bounds, eye);
  const SpaceGrid grid(model, bounds);
  if (eye && bounds.contains(*eye)) {
    const Place place = look_around(grid, stand_at(grid, *eye));
    return standing_at(grid, place, place.is_room() ? SceneKind::kRoom : SceneKind::kSite);
  }
  if (eye) return before_object(model, bounds, eye);
  const BestPlaces best = find_places(grid);
  if (best.room) return standing_at(grid, *best.room, SceneKind::kRoom);
  // If nothing rises to the height of the eye, the surface may be the top of an object, unless it is as flat as a
  // plain.
  const double flatness = best.site && best.site->walls > 0 ? 0.7 : 2.0;
  // A small level area, such as the top of a globe, is not ground.
  const bool has_ground = best.site && best.site->walkable_m2 > std::min(0.35 * size.x() * size.z(), kMuchGroundM2);
  const bool is_wide = has_ground && std::min(size.x(), size.z()) >= std::max(kMinSiteM, flatness * size.y());
  const bool is_court = has_ground && best.site->has_walls() && size.y() < kMaxCourtM;
  if (is_wide || is_court) return standing_at(grid, *best.site, SceneKind::kSite);
  return before_object(model, bounds, std::nullopt);
}

}  // namespace cyclorama::scene
