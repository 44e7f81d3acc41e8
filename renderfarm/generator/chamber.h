// SPDX-License-Identifier: Apache-2.0
/// The chamber in the rock: walls with niches, coved ceiling, floor, altar and entrance corridor. It has no gaps at any
/// grid density: walls and ceiling meet at straight edges, where the rock's roughness fades out, and the coves share
/// their vertices at the hips. Floor, altar and corridor extend through the surfaces that they meet. All patches face
/// inwards.
#pragma once

#include <cstdint>
#include <vector>

#include "renderfarm/generator/surface.h"

namespace cyclorama::generator {

// The room: x along the length, z across (the altar at -z), y up; the origin is in the middle of the floor.
inline constexpr float kHalfLength = 9.0f;
inline constexpr float kHalfDepth = 3.6f;
inline constexpr float kWallHeight = 4.3f;
inline constexpr float kCoveDepth = 2.3f;  ///< Horizontal depth of the coves.
inline constexpr float kTopHeight = 6.9f;
inline constexpr float kAltarFront = -0.80f;
inline constexpr float kAltarHeight = 0.80f;
inline constexpr float kDoorHalfWidth = 1.15f;
inline constexpr float kDoorHeight = 2.7f;
inline constexpr float kCorridorEnd = 6.6f;

/// A recess in a wall for a seated figure.
struct Niche {
  float centre = 0.0f;  ///< Position along the wall.
  float sill = 0.0f;    ///< Height of the niche's floor.
  float width = 1.0f;
  float height = 1.4f;
  float depth = 0.6f;
};

/// Frame of a wall: `along` points to the right for a viewer who faces the wall; `inward` points into the room.
struct WallFrame {
  Vec3 origin;  ///< Point on the floor from which `along` is measured.
  Vec3 along;
  Vec3 inward;
  std::vector<Niche> niches;
  bool has_door = false;  ///< The wall has a door in its middle.

  /// Returns a point on the floor of niche `i`, `forward` metres into the room from the plane of the wall.
  [[nodiscard]] Vec3 in_niche(std::size_t i, float forward) const;
};

enum class Side { kAltar, kHead, kFeet, kEntrance };
[[nodiscard]] WallFrame wall_frame(Side side);

[[nodiscard]] std::vector<Patch> wall(Side side, std::uint32_t seed);
[[nodiscard]] std::vector<Patch> ceiling(std::uint32_t seed);
[[nodiscard]] std::vector<Patch> floor_and_corridor(std::uint32_t seed);
[[nodiscard]] std::vector<Patch> altar(std::uint32_t seed);

}  // namespace cyclorama::generator
