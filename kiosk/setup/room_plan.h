// SPDX-License-Identifier: Apache-2.0
/// A museum's room from a few measured numbers, as a first guess that the calibration replaces.
///
///        ┌──────── width ────────┐          cylinder: the visitor's eye stands in its centre
///        │ top                   │          plane: in front of its middle
///   ─────┴───── bottom ──────────┴───── floor
///   each projector: under the ceiling, at a distance from the wall, before its own part of it
#pragma once

#include <string>
#include <vector>

#include "common/base/result.h"

namespace cyclorama::setup {

struct PlannedProjector {
  std::string name;
  std::string connector;
  std::string pjlink{};  ///< HOST or HOST:PORT; empty: switched by hand.
  int turn_deg = 0;
  int width_px = 1920;
  int height_px = 1080;
};

/// Lengths that an installer measures with a tape. A value.
struct RoomPlan {
  std::string name = "The museum's room";
  bool is_round = true;
  double radius_m = 3.0;    ///< Radius of a round wall.
  double arc_deg = 126.0;   ///< Angle of a round wall, seen from its centre.
  double width_m = 4.8;     ///< Width of a flat wall.
  double distance_m = 2.6;  ///< Distance of a flat wall from the visitor's eye.
  double bottom_m = 0.4;
  double top_m = 2.9;
  double eye_m = 1.65;
  double lens_height_m = 2.75;
  double lens_distance_m = 3.4;                ///< From a projector's lens to its part of the wall.
  double picture_width_m = 4.8;                ///< Width of one projector's picture on the wall.
  std::vector<PlannedProjector> projectors{};  ///< From left to right.
};

/// Returns installation.toml for the plan. Precondition: there is a projector.
[[nodiscard]] std::string installation_toml(const RoomPlan& plan);

/// A point on the unrolled wall: metres along it from its left edge, and above the floor.
struct WallPoint {
  double along_m = 0.0;
  double height_m = 0.0;
};

/// Each projector's picture on the wall, and how much of the wall all of them light.
struct Reach {
  double length_m = 0.0;                         ///< Length of the wall, along it.
  std::vector<std::vector<WallPoint>> pictures;  ///< Outline of each projector's picture, where it meets the wall.
  double lit_fraction = 0.0;
  double shared_fraction = 0.0;    ///< Lit by two or more projectors, which blending needs.
  std::vector<std::string> hints;  ///< Sentences on what to move; empty: all of the wall is reached.
};

/// Computes what the installation of the plan lights, by its own geometry. Errors: those of parse_installation().
Result<Reach> reach_of(const RoomPlan& plan);

}  // namespace cyclorama::setup
