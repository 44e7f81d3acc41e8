// SPDX-License-Identifier: Apache-2.0
/// Decides, from new observations and the wall and lens that were fitted before, whether a projector was displaced (a
/// rigid motion, six parameters), its lens was turned, or neither.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "appliance/scan/realign/wall_direction.h"
#include "appliance/solve/map_fit.h"
#include "appliance/solve/surface_fit.h"

namespace cyclorama::scan {

enum class DisplacementVerdict {
  kDisplaced,    ///< A rigid motion explains the observations.
  kLensTurned,   ///< Only a rigid motion with another focal length and principal point explains them.
  kUnexplained,  ///< No motion or lens explains them: the wall has changed, or something stands in the light.
};

struct Displacement {
  DisplacementVerdict verdict = DisplacementVerdict::kUnexplained;
  calibration::FittedProjector projector;  ///< The new pose with its covariance; the lens is unchanged.
  double turned_rad = 0.0;                 ///< Rotation from the old pose.
  double moved_m = 0.0;                    ///< Translation of the centre from the old pose.
  double before_px = 0.0;                  ///< RMS residual per axis of the old map.
  double after_px = 0.0;                   ///< RMS residual per axis of the new observations.
  double with_lens_px = 0.0;               ///< `after_px` with free focal length and principal point; 0 if not tried.
  double zoom = 1.0;          ///< Focal length of that trial, relative to the old one.
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< Shift of the principal point in that trial.
};

/// Explains new observations of a projector. `before` and `map` are of the previous calibration. `seen` holds pixels of
/// the projector's picture with the directions in which the sweet spot sees them now. Returns nothing if there are too
/// few observations or no pose fits them. Reentrant.
[[nodiscard]] std::optional<Displacement> find_displacement(const calibration::FittedProjector& before,
                                                            const calibration::MeasuredMap& map,
                                                            std::span<const solve::MapSample> seen,
                                                            const InverseDepthAt& inverse_depth);

/// Returns the direction in which the sweet spot sees a projector's pixel on the wall; nothing if the pixel misses the
/// wall.
[[nodiscard]] std::optional<Eigen::Vector3d> drawn_direction(const calibration::FittedProjector& projector,
                                                             const calibration::BrownLens& lens,
                                                             const Eigen::Vector2d& pixel,
                                                             const InverseDepthAt& inverse_depth);

}  // namespace cyclorama::scan
