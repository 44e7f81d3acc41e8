// SPDX-License-Identifier: Apache-2.0
/// Where a visitor can walk in a scene, found with rays: down for the ground and the head room, around for what is in
/// the way. The eye keeps its height (the paper's walk), so ground counts as far as it suits that height.
///
///        ceiling ▔▔▔▔▔▔▔▔▔▔▔      at each cell of 5 cm, from the start on:
///          head room  ↑            1. ground: a surface in the band below the eye, with head room above it
///     eye ──●─ ─ ─ ─ ─ ─ ─ ─       2. no step higher than a stair's to the next cell, and no steeper than kSteepest
///   ←──→   ╱│╲  ←──→               3. nothing within the body's radius, from the knee to above the head
///  radius   │  radius
///   ▁▁▁▁▁▁▁▁▁▁▁▁▁╱▔▔ band          The cells that can be reached so become polygons, with holes around pillars.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/base/result.h"
#include "renderfarm/scene/outline.h"
#include "renderfarm/scene/scene.h"
#include "renderfarm/walkable/ray_probe.h"

namespace cyclorama {

/// Of a person whose eyes are 1.6 m above the ground; a scene whose visitor is of another size scales all.
struct BodySize {
  double eye_m = 1.6;
  double radius_m = 0.30;       ///< Kept from everything; less where the start has less.
  double headroom_m = 0.15;     ///< Above the eye.
  double step_m = 0.25;         ///< What one steps up or down, and over.
  double knee_m = 0.45;         ///< Lower things one may stand beside.
  double lower_m = 0.64;        ///< Ground so much below the start's is still ground,
  double higher_m = 0.40;       ///< and so much above it: beyond, an eye of fixed height would be too high or too low.
  double gap_m = 0.15;          ///< Missing ground that one does not notice; scans have such holes.
  double steepest_rad = 0.785;  ///< 45 degrees over 0.6 m, as of steep stairs: more is climbing.
};

struct GroundOptions {
  double cell_m = 0.05;    ///< For an eye at 1.6 m.
  double reach_m = 100.0;  ///< From the start, each way; the same.
};

/// What was found at a cell.
enum class GroundKind : std::uint8_t { kUnseen, kNone, kBlocked, kSteep, kWalkable };

struct WalkableGround {
  std::vector<Eigen::Vector2d> outline;
  std::vector<std::vector<Eigen::Vector2d>> holes;
  double area_m2 = 0.0;   ///< Of the cells.
  double radius_m = 0.0;  ///< That was kept.
  double floor_m = 0.0;   ///< At the start.
  double cell_m = 0.0;
  // For pictures: cell (x, z) is kinds[z * width + x], its least corner `least + cell_m * (x, z)`.
  int width = 0;
  int depth = 0;
  Eigen::Vector2d least = Eigen::Vector2d::Zero();
  std::vector<GroundKind> kinds;
};

/// From where the scene starts. Seconds, for a site of some hundred square metres. Reentrant.
/// kInvalidArgument  there is no ground below the start, or no room to stand: the message says what is in the way.
Result<WalkableGround> find_walkable(const RayProbe& probe, const SceneInfo& info, const Eigen::AlignedBox3d& bounds,
                                     const GroundOptions& options);

}  // namespace cyclorama
