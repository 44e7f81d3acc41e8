// SPDX-License-Identifier: Apache-2.0
/// Finds the walkable area of a scene with rays: downwards for the ground and the headroom, sideways for obstacles.
/// Visitors' eyes keep their height, so only ground that suits that height is walkable.
///
///        ceiling ▔▔▔▔▔▔▔▔▔▔▔      at each cell of 5 cm, beginning with the start:
///          headroom   ↑            1. ground: a surface in the band below the eye, with headroom above it
///     eye ──●─ ─ ─ ─ ─ ─ ─ ─       2. no step to the next cell higher than a stair's, and no slope above steepest_rad
///   ←──→   ╱│╲  ←──→               3. nothing within the body's radius, from the knee up to the headroom
///  radius   │  radius
///   ▁▁▁▁▁▁▁▁▁▁▁▁▁╱▔▔ band
///
/// The cells that are reachable in this way become polygons, with holes around pillars.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/outline.h"
#include "renderfarm/scene/scene.h"
#include "renderfarm/walkable/ray_probe.h"

namespace cyclorama::walkable {

/// Dimensions of a person whose eyes are 1.6 m above the ground; they scale with the eye height of a scene's visitor.
struct BodySize {
  double eye_m = 1.6;
  double radius_m = 0.30;    ///< Clearance from obstacles; reduced if the start has less.
  double headroom_m = 0.15;  ///< Free height above the eye.
  double step_m = 0.25;      ///< Height that can be stepped up, down, or over.
  double knee_m = 0.45;      ///< Obstacles below this height do not matter.
  /// Limits to how far the ground may be below and above the ground at the start; beyond them, an eye of fixed height
  /// would be too high or too low.
  double lower_m = 0.64;
  double higher_m = 0.40;
  double gap_m = 0.15;          ///< Width of holes in the ground that are bridged; scans have such holes.
  double steepest_rad = 0.785;  ///< Maximum slope over 0.6 m: 45 degrees, as on steep stairs.
};

struct GroundOptions {
  double cell_m = 0.05;    ///< Side of a cell, for an eye at 1.6 m.
  double reach_m = 100.0;  ///< Distance searched in each direction from the start, for an eye at 1.6 m.
};

/// Result of the search at a cell.
enum class GroundKind : std::uint8_t { kUnseen, kNone, kBlocked, kSteep, kWalkable };

struct WalkableGround {
  std::vector<Eigen::Vector2d> outline;
  std::vector<std::vector<Eigen::Vector2d>> holes;
  double area_m2 = 0.0;   ///< Area of the walkable cells.
  double radius_m = 0.0;  ///< Clearance that was applied.
  double floor_m = 0.0;   ///< Height of the ground at the start.
  double cell_m = 0.0;
  // For pictures: cell (x, z) is kinds[z * width + x]; its corner with the lowest coordinates is `min + cell_m * (x,
  // z)`.
  int width = 0;
  int depth = 0;
  Eigen::Vector2d min = Eigen::Vector2d::Zero();
  std::vector<GroundKind> kinds;
};

/// Searches from the start of the scene. Takes seconds for a site of some hundred square metres. Reentrant. Errors:
/// kInvalidArgument if there is no ground below the start or no room to stand; the message names the obstacle.
Result<WalkableGround> find_walkable(const RayProbe& probe, const scene::SceneInfo& info,
                                     const Eigen::AlignedBox3d& bounds, const GroundOptions& options);

}  // namespace cyclorama::walkable
