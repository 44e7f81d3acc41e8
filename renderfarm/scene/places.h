// SPDX-License-Identifier: Apache-2.0
/// Where a visitor may stand in a place, and how much there is to see. Each candidate is judged by a small picture of
/// distances, traced through the SpaceGrid.
#pragma once

#include <optional>

#include "renderfarm/scene/ground.h"
#include "renderfarm/scene/space_grid.h"

namespace cyclorama::scene {

inline constexpr double kEyeHeightM = 1.6;

/// Direction of a heading: 0 looks along -z, positive turns to the right.
[[nodiscard]] Eigen::Vector3d ahead(double heading_rad);

/// The view from a place in its best direction; its surfaces are counted as parts of a picture.
struct PlaceView {
  double heading_rad = 0.0;
  double seen = 0.0;     ///< Surfaces, from their front.
  double near = 0.0;     ///< Surfaces nearer than a step.
  double ground = 0.0;   ///< Ground at the visitor's feet, all around.
  double depth_m = 0.0;  ///< Mean distance of what is seen, each at most 15 m.

  [[nodiscard]] double score() const;
};

/// A standing position and what is visible from it.
struct Place {
  Standing standing;
  int walls = 0;  ///< Number of directions, of kDirections, in which something is hit at eye height.
  int from_behind = 0;
  bool has_ceiling = false;
  double ceiling_m = 0.0;  ///< Height above the eye.
  double nearest_m = 0.0;
  double mean_m = 0.0;
  double view_heading_rad = 0.0;  ///< Heading of the longest view.
  double walkable_m2 = 0.0;       ///< Set by find_places() only.

  static constexpr int kDirections = 32;
  [[nodiscard]] bool is_inside_solid() const { return 2 * from_behind > walls; }
  [[nodiscard]] bool has_walls() const { return 4 * walls >= 3 * kDirections && !is_inside_solid(); }
  [[nodiscard]] bool is_room() const { return has_ceiling && ceiling_m < kMaxCeilingM && has_walls(); }
  /// No building has a ceiling this high: what looks like one is the inside of an object in another unit.
  [[nodiscard]] bool is_inside_vessel() const { return has_ceiling && ceiling_m >= kMaxCeilingM && has_walls(); }
  static constexpr double kMaxCeilingM = 60.0;
};

/// Looks around at eye height.
[[nodiscard]] Place look_around(const SpaceGrid& grid, const Standing& standing);
/// Traces the small picture of a place and selects its best direction.
[[nodiscard]] PlaceView view_at(const SpaceGrid& grid, const Place& place);

struct BestPlaces {
  std::optional<Place> room;
  std::optional<Place> site;
};

/// Returns the best room, or the best site if there are no rooms; its view_heading_rad is that of the best view. A
/// position on a small piece of ground, such as a plinth, is not chosen if there is a much larger piece. Takes less
/// than a second.
[[nodiscard]] BestPlaces find_places(const SpaceGrid& grid);

}  // namespace cyclorama::scene
