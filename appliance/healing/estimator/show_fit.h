// SPDX-License-Identifier: Apache-2.0
/// Where projectors and fixed cameras stand, from pixels and the places of the wall that they light or see: what the
/// continuous calibration begins with. Reentrant.
#pragma once

#include <span>

#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/show_calibration.h"
#include "common/base/result.h"

namespace cyclorama::healing {

/// A pixel, and the place in the room that it lights or sees.
struct WallCorrespondence {
  Eigen::Vector2d pixel{0.0, 0.0};
  Eigen::Vector3d position{0.0, 0.0, 0.0};
};

template <typename Body>
struct FittedPose {
  calibration::BrownParameters lens;
  RigidTransform<frame::Room, Body> pose;
  double rms_px = 0.0;   ///< Of the distance, without the worst twentieth.
  std::size_t used = 0;  ///< Pixels within some deviations.
};

/// The projector whose pixels land where its map and the wall say. `installed` is where the search begins, and what is
/// taken where the wall does not tell: of a flat one the focal length and the distance look alike.
/// kInvalidArgument  its map tells fewer than 40 places on the wall.     kBadData  nothing fits: says by how much.
Result<FittedPose<frame::Projector>> fit_projector(const calibration::MeasuredMap& map, const Wall& wall,
                                                   const Point<frame::Room>& sweet_spot,
                                                   const calibration::ShowProjector& installed);

/// A camera of a known lens, wherever it stands; up to half of the pixels may be wrong.
/// Errors as fit_projector().
Result<FittedPose<frame::Camera>> place_camera(const calibration::BrownParameters& lens,
                                               std::span<const WallCorrespondence> pixels);

/// The lens of a picture that is smaller by `factor` each way, rounded down.
[[nodiscard]] calibration::BrownParameters smaller_lens(const calibration::BrownParameters& lens, int factor);

}  // namespace cyclorama::healing
