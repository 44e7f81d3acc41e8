// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/scene/found_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "renderfarm/scene/back_faces.h"
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

/// Returns the heading for an object. The visitor stands on the side of +z, which is the front in glTF, unless another
/// side shows much more of the object: the broad side of a flat thing, or the front of a sheet that is open at its
/// back.
double heading_before(const Model& model) {
  constexpr double kMinFront = 0.35;
  constexpr double kMuchMore = 1.05;
  const Facings facings = facings_of(model);
  std::size_t best = 0;
  // Straight views come first, so that a diagonal one must show more.
  for (const std::size_t side : {0u, 2u, 6u, 4u, 1u, 7u, 3u, 5u}) {
    if (facings.seen_from[side] > kMuchMore * facings.seen_from[best]) best = side;
  }
  if (facings.seen_from[0] >= kMinFront * facings.seen_from[best]) return 0.0;
  return -2.0 * std::numbers::pi * static_cast<double>(best) / Facings::kSides;
}

/// A level view of a whole object.
struct ViewBefore {
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  double distance_m = 1.0;  ///< From the object's nearest side.
};

/// Returns the eye before `bounds` that sees all of it between tangents of -0.5 and 0.3, as on a wall that is 2.6 m
/// high and 3 m away. A thing that lies flat is seen from higher up.
ViewBefore view_before(const Eigen::AlignedBox3d& bounds, double heading_rad) {
  constexpr double kDistanceByHeight = 1.3;
  constexpr double kDistanceByWidth = 0.8;
  constexpr double kLookDown = 0.35;  // Tangent towards the middle of a flat thing.
  constexpr double kMaxDown = 0.5;    // Tangent towards its nearest edge.
  constexpr double kFlat = 0.2;
  constexpr double kUpright = 0.6;
  const Eigen::Vector3d size = bounds.sizes();
  const double sine = std::abs(std::sin(heading_rad));
  const double cosine = std::abs(std::cos(heading_rad));
  const double width = cosine * size.x() + sine * size.z();
  const double depth = sine * size.x() + cosine * size.z();
  ViewBefore view;
  view.distance_m = std::max({kDistanceByHeight * size.y(), kDistanceByWidth * width, 0.1 * size.maxCoeff(), 1e-3});
  const double flatness = std::clamp((kUpright - size.y() / std::max(depth, 1e-9)) / (kUpright - kFlat), 0.0, 1.0);
  const double upright_m = 0.1 * size.y();
  const double raised_m =
      std::min(kLookDown * (view.distance_m + 0.5 * depth), kMaxDown * view.distance_m - 0.5 * size.y());
  const double above_m = std::max(upright_m, flatness * raised_m);
  view.eye =
      bounds.center() + above_m * Eigen::Vector3d::UnitY() - (0.5 * depth + view.distance_m) * ahead(heading_rad);
  return view;
}

FoundSettings before_object(const Eigen::AlignedBox3d& bounds, double heading_rad,
                            const std::optional<Eigen::Vector3d>& eye) {
  // Viewing distance of an object as tall as a person; steps have their usual length at this distance.
  constexpr double kUsualDistanceM = 2.5;
  const Eigen::Vector3d size = bounds.sizes();
  const Eigen::Vector3d middle = bounds.center();
  FoundSettings found;
  found.kind = SceneKind::kObject;
  found.heading_rad = heading_rad;
  const ViewBefore view = view_before(bounds, heading_rad);
  const double distance = view.distance_m;
  found.eye = eye.value_or(view.eye);
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

/// Returns true for a room that people could have built: it is not the inside of a solid thing, and a high one is no
/// cavity of a large machine or statue.
bool is_building(const Model& model, const Place& room, const Eigen::Vector3d& size) {
  constexpr double kUsualHeightM = 15.0;
  constexpr double kStoreyM = 6.0;
  constexpr double kMinShare = 0.1;
  const double height = room.ceiling_m + room.standing.eye_height_m();
  // Things that stand in a room show their fronts, and so do parts that reach into a hollow thing. Walls that face
  // either way are usual in rooms of the usual height only.
  const double max_back_faces = height <= kStoreyM ? 0.5 : 0.3;
  if (back_face_share(model, room.standing.eye).value_or(0.0) > max_back_faces) return false;
  if (height <= kUsualHeightM) return true;
  return room.walkable_m2 > kMinShare * size.x() * size.z();
}

bool is_site(const Place& site, const Eigen::Vector3d& size) {
  // If nothing rises to the height of the eye, the surface may be the top of an object, unless it is as flat as a
  // plain.
  const double flatness = site.walls > 0 ? 0.7 : 2.0;
  // A small level area, such as the top of a globe, is not ground.
  const double footprint = size.x() * size.z();
  const bool has_ground = site.walkable_m2 > std::min(0.45 * footprint, std::max(kMuchGroundM2, 0.1 * footprint));
  const bool is_wide = has_ground && std::min(size.x(), size.z()) >= std::max(kMinSiteM, flatness * size.y());
  const bool is_court = has_ground && site.has_walls() && size.y() < kMaxCourtM;
  return is_wide || is_court;
}

/// Returns the settings of a site that was found in a grid of the whole scene. The cells of a large scene are larger
/// than people, so the surroundings are looked at again in smaller ones. Nothing for a landscape, which is looked at
/// from above: a scene of more than 2 km, or one where all around is an empty plain.
std::optional<FoundSettings> standing_near(const Model& model, const SpaceGrid& grid, const Place& place) {
  constexpr double kFineCellM = 0.6;
  constexpr double kFarM = 60.0;
  constexpr double kLandscapeCellM = 20.0;
  if (grid.cell_m() > kLandscapeCellM) return std::nullopt;
  if (grid.cell_m() <= kFineCellM) return standing_at(grid, place, SceneKind::kSite);
  const Eigen::Vector3d reach(24.0, 12.0, 24.0);
  const SpaceGrid fine(model, {place.standing.eye - reach, place.standing.eye + reach});
  const std::optional<Place> near = find_places(fine).site;
  const bool is_empty = near && near->walls == 0 && (place.walls == 0 || place.nearest_m > kFarM);
  if (is_empty) return std::nullopt;
  return near ? standing_at(fine, *near, SceneKind::kSite) : standing_at(grid, place, SceneKind::kSite);
}

/// Returns the heading from which a small room is looked into through a side that lacks its wall, as a stage is.
std::optional<double> heading_into(const SpaceGrid& grid, const Eigen::AlignedBox3d& bounds) {
  constexpr double kMaxStageM = 8.0;
  constexpr double kDeep = 0.25;
  constexpr double kMinOpen = 0.7;
  constexpr int kRays = 16;  // In each direction of the side.
  const Eigen::Vector3d size = bounds.sizes();
  if (size.maxCoeff() > kMaxStageM) return std::nullopt;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double heading = 0.5 * std::numbers::pi * quarter;
    const Eigen::Vector3d into = ahead(heading);
    const Eigen::Vector3d aside = ahead(heading + 0.5 * std::numbers::pi);
    const double depth = std::abs(size.dot(into.cwiseAbs()));
    const double width = std::abs(size.dot(aside.cwiseAbs()));
    int open = 0;
    for (int i = 0; i < kRays * kRays; ++i) {
      const int column = i % kRays;
      const int row = i / kRays;
      const double across = (column + 0.5) / kRays - 0.5;
      const double up = (row + 0.5) / kRays - 0.5;
      const Eigen::Vector3d from =
          bounds.center() + across * width * aside + up * size.y() * Eigen::Vector3d::UnitY() - 0.5 * depth * into;
      const SpaceGrid::Ray ray = grid.cast(from, into);
      const bool starts_in_wall = grid.is_solid(grid.cell_of(from));
      if (!starts_in_wall && ray.hits && ray.length_m > kDeep * depth) ++open;
    }
    if (open >= kMinOpen * kRays * kRays) return heading;
  }
  return std::nullopt;
}

}  // namespace

Viewpoint level_viewpoint(const Viewpoint& view, const Eigen::AlignedBox3d& bounds) {
  constexpr double kMinShown = 0.7;
  constexpr double kTop = 0.3;
  constexpr double kBottom = -0.5;
  const Eigen::Vector3d towards = bounds.center() - view.eye;
  const double distance = std::hypot(towards.x(), towards.z());
  const Eigen::Vector2d ahead_of_camera(view.direction.x(), view.direction.z());
  const bool looks_down = ahead_of_camera.norm() < 0.1;
  if (bounds.contains(view.eye)) return view;
  const double lowest = (bounds.min().y() - view.eye.y()) / std::max(distance, 1e-9);
  const double highest = (bounds.max().y() - view.eye.y()) / std::max(distance, 1e-9);
  const double shown = std::min(highest, kTop) - std::max(lowest, kBottom);
  if (!looks_down && shown >= kMinShown * std::min(highest - lowest, kTop - kBottom)) return view;
  Viewpoint level = view;
  const Eigen::Vector3d level_direction = looks_down ? Eigen::Vector3d(towards.x(), 0.0, towards.z())
                                                     : Eigen::Vector3d(view.direction.x(), 0.0, view.direction.z());
  level.direction = level_direction.norm() > 1e-9 * (1.0 + distance) ? level_direction.normalized() : ahead(0.0);
  level.eye = view_before(bounds, std::atan2(level.direction.x(), -level.direction.z())).eye;
  return level;
}

FoundSettings find_settings(const Model& model, const Eigen::AlignedBox3d& bounds,
                            const std::optional<Eigen::Vector3d>& eye) {
  const Eigen::Vector3d size = bounds.sizes();
  if (size.minCoeff() < kMinPlaceM && std::min(size.x(), size.z()) < kMinSiteM)
    return before_object(bounds, eye ? 0.0 : heading_before(model), eye);
  const SpaceGrid grid(model, bounds);
  if (eye && bounds.contains(*eye)) {
    const Place place = look_around(grid, stand_at(grid, *eye));
    return standing_at(grid, place, place.is_room() ? SceneKind::kRoom : SceneKind::kSite);
  }
  if (eye) return before_object(bounds, 0.0, eye);
  if (const std::optional<double> heading = heading_into(grid, bounds)) {
    FoundSettings found = before_object(bounds, *heading, std::nullopt);
    found.is_stage = true;
    return found;
  }
  const BestPlaces best = find_places(grid);
  if (best.room && is_building(model, *best.room, size)) return standing_at(grid, *best.room, SceneKind::kRoom);
  if (best.site && is_site(*best.site, size)) {
    const std::optional<FoundSettings> found = standing_near(model, grid, *best.site);
    if (found) return *found;
  }
  return before_object(bounds, heading_before(model), std::nullopt);
}

}  // namespace cyclorama::scene
