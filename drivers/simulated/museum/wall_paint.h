// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "drivers/simulated/museum/true_wall.h"

namespace cyclorama::simulated {

/// Describes what a wall's surface does to light besides its even, matt albedo. Places across and along are WallPosition's, of
/// each part. A value; reentrant.
struct WallPaint {
  /// A line from top to bottom, where two strips of paint or two boards meet.
  struct Seam {
    double across = 0.5;
    double width = 0.002;  ///< In parts of the wall's width.
    double albedo = 0.85;  ///< Relative to the wall's.
  };
  /// A rectangle of another paint, such as a door, with gloss.
  struct Panel {
    double left = 0.0, right = 0.0, low = 0.0, high = 0.0;
    double albedo = 0.6;
    double gloss = 0.0;
  };
  std::vector<Seam> seams;
  std::vector<Panel> panels;
  double plaster = 0.0;  ///< Largest relative change of the albedo by the plaster's grain.
  double plaster_grain_m = 0.006;
  double sheen = 0.0;  ///< Mirrored light of the whole wall, relative to the matt light.
  double sheen_exponent = 20.0;

  [[nodiscard]] bool is_plain() const { return seams.empty() && panels.empty() && plaster == 0.0 && sheen == 0.0; }
  /// Albedo at a place, relative to the wall's.
  [[nodiscard]] double albedo_at(const TrueWall::Hit& at) const;
  /// Light that arrives at `eye` from a lamp at `source`, relative to that of a matt wall of the same albedo.
  [[nodiscard]] double seen_at(const TrueWall::Hit& at, const Eigen::Vector3d& source,
                               const Eigen::Vector3d& eye) const;
};

}  // namespace cyclorama::simulated
