// SPDX-License-Identifier: Apache-2.0
/// Poses of projectors and fixed cameras, from pixels and the points of the wall that they light or see: the start of
/// the continuous calibration. Reentrant.
#pragma once

#include <span>

#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/show_calibration.h"
#include "common/base/result.h"

namespace cyclorama::healing {

/// A pixel, and the point of the room that it lights or sees.
struct WallCorrespondence {
  Eigen::Vector2d pixel{0.0, 0.0};
  Eigen::Vector3d position{0.0, 0.0, 0.0};
};

template <typename Body>
struct FittedPose {
  calibration::BrownParameters lens;
  RigidTransform<frame::Room, Body> pose;
  double rms_px = 0.0;   ///< Root mean square distance without the worst twentieth.
  std::size_t used = 0;  ///< Number of pixels that fit.
};

/// Fits a projector's lens and pose to the points of the wall where its pixels land according to its map. `installed`
/// is the start of the search and a weak prior for the lens: on a flat wall, focal length and distance cannot be told
/// apart otherwise. Errors: kInvalidArgument if the map has fewer than 40 points on the wall; kBadData if no pose fits,
/// with the residual.
Result<FittedPose<frame::Projector>> fit_projector(const calibration::MeasuredMap& map, const Wall& wall,
                                                   const Point<frame::Room>& sweet_spot,
                                                   const calibration::ShowProjector& installed);

/// Fits the pose of a camera with a known lens, without an initial pose; up to half of the pixels may be outliers.
/// Errors: those of fit_projector().
Result<FittedPose<frame::Camera>> place_camera(const calibration::BrownParameters& lens,
                                               std::span<const WallCorrespondence> pixels);

/// Returns the lens of a picture that is reduced by `factor` each way, rounded down.
[[nodiscard]] calibration::BrownParameters smaller_lens(const calibration::BrownParameters& lens, int factor);

}  // namespace cyclorama::healing
