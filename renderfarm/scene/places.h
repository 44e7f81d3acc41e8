// SPDX-License-Identifier: Apache-2.0
/// Positions where a visitor may stand in a scene, and how much is visible from them. Each candidate is judged by a
/// small picture of distances that is traced through the SpaceGrid.
#pragma once

#include <optional>

#include "renderfarm/scene/ground.h"
#include "renderfarm/scene/space_grid.h"

namespace cyclorama::scene {

inline constexpr double kEyeHeightM = 1.6;

/// Returns the direction of a heading: 0 looks along -z, and positive values turn to the right.
[[nodiscard]] Eigen::Vector3d ahead(double heading_rad);

/// The view from a place in its best direction. Surfaces and ground are measured as shares of a picture.
struct PlaceView {
  double heading_rad = 0.0;
  double seen = 0.0;     ///< Share of the picture that shows surfaces from their front.
  double near = 0.0;     ///< Share of the picture with surfaces nearer than a step.
  double ground = 0.0;   ///< Share of all horizontal directions with ground at the visitor's feet.
  double depth_m = 0.0;  ///< Mean distance of the surfaces, each counted as at most 15 m.
  double edges = 0.0;    ///< Share of the columns where something stands before or beside something else.

  [[nodiscard]] double score() const;
};

/// A standing position and what is visible from it.
struct Place {
  Standing standing;
  int walls = 0;  ///< Number of directions, out of kDirections, in which a surface is hit at eye height.
  int from_behind = 0;
  bool has_ceiling = false;
  double ceiling_m = 0.0;  ///< Height above the eye.
  bool is_resolved = false;  ///< The height from floor to ceiling is several cells.
  double nearest_m = 0.0;
  double mean_m = 0.0;
  double view_heading_rad = 0.0;  ///< Heading of the longest view.
  double walkable_m2 = 0.0;       ///< Set only by find_places().

  static constexpr int kDirections = 32;
  [[nodiscard]] bool is_inside_solid() const { return 2 * from_behind > walls; }
  [[nodiscard]] bool has_walls() const { return 4 * walls >= 3 * kDirections && !is_inside_solid(); }
  [[nodiscard]] bool is_room() const { return has_ceiling && is_resolved && ceiling_m < kMaxCeilingM && has_walls(); }
  /// Returns true inside an object whose unit is wrong: no building has a ceiling this high.
  [[nodiscard]] bool is_inside_vessel() const { return has_ceiling && ceiling_m >= kMaxCeilingM && has_walls(); }
  static constexpr double kMaxCeilingM = 60.0;
};

/// Measures the surroundings of a position at eye height.
[[nodiscard]] Place look_around(const SpaceGrid& grid, const Standing& standing);
/// Traces the small picture of a place and selects its best direction.
[[nodiscard]] PlaceView view_at(const SpaceGrid& grid, const Place& place);

struct BestPlaces {
  std::optional<Place> room;
  std::optional<Place> site;
};

/// Returns the best room and the best site. The view_heading_rad of the result is that of the best view. A position on
/// a small piece of ground, such as a plinth, is not chosen if there is a much larger piece. Takes less than a second.
[[nodiscard]] BestPlaces find_places(const SpaceGrid& grid);

}  // namespace cyclorama::scene
