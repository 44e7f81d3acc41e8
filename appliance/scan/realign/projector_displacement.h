// SPDX-License-Identifier: Apache-2.0
/// Explains what is seen of a projector by the wall and the lens that were fitted before: it was displaced, which six
/// numbers describe; or its lens was turned; or neither.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "appliance/scan/realign/line_of_sight.h"
#include "appliance/solve/map_fit.h"
#include "appliance/solve/surface_fit.h"

namespace cyclorama {

enum class DisplacementVerdict {
  kDisplaced,    ///< A rigid motion explains it.
  kLensTurned,   ///< A rigid motion with another focal length and principal point explains it.
  kUnexplained,  ///< The wall differs there, or something stands in the light.
};

struct Displacement {
  DisplacementVerdict verdict = DisplacementVerdict::kUnexplained;
  FittedProjector projector;  ///< As it stands now, with the covariance of its pose; its lens as before.
  double turned_rad = 0.0;    ///< From where it stood,
  double moved_m = 0.0;       ///< its centre.
  double before_px = 0.0;     ///< Per axis: what wall and lens left unexplained of its map of before,
  double after_px = 0.0;      ///< and leave of what is seen now.
  double with_lens_px = 0.0;  ///< With a free focal length and centre; 0 where it was not tried.
  double zoom = 1.0;          ///< The focal length in parts of the one of before, of that trial.
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< Of its centre, likewise.
};

/// `seen` are places of its picture as the sweet spot sees them now. Nothing where there are too few, or no pose goes
/// with them. Reentrant.
[[nodiscard]] std::optional<Displacement> find_displacement(const FittedProjector& before, const MeasuredMap& map,
                                                            std::span<const MapSample> seen,
                                                            const NearnessAt& nearness);

/// Where a projector of that pose and lens draws its pixel, by the wall. Nothing where it draws nowhere.
[[nodiscard]] std::optional<Eigen::Vector3d> drawn_direction(const FittedProjector& projector, const BrownLens& lens,
                                                             const Eigen::Vector2d& pixel, const NearnessAt& nearness);

}  // namespace cyclorama
