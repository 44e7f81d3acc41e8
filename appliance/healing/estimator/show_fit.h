// SPDX-License-Identifier: Apache-2.0
/// Where projectors and fixed cameras stand, from pixels and the places of the wall that they light or see: what the
/// continuous calibration begins with. Reentrant.
#pragma once

#include <span>

#include "appliance/calibration/measured_map.h"
#include "appliance/calibration/show_calibration.h"
#include "common/base/result.h"

namespace cyclorama {

/// A pixel, and the place in the room that it lights or sees.
struct PlacedPixel {
  Eigen::Vector2d pixel{0.0, 0.0};
  Eigen::Vector3d place{0.0, 0.0, 0.0};
};

template <typename Body>
struct FittedPlace {
  BrownParameters lens;
  RigidTransform<frame::Room, Body> pose;
  double rms_px = 0.0;   ///< Of the distance, without the worst twentieth.
  std::size_t used = 0;  ///< Pixels within some deviations.
};

/// The projector whose pixels land where its map and the wall say. `installed` is where the search begins, and what is
/// taken where the wall does not tell: of a flat one the focal length and the distance look alike.
/// kInvalidArgument  its map tells fewer than 40 places on the wall.     kBadData  nothing fits: says by how much.
Result<FittedPlace<frame::Projector>> fit_projector(const MeasuredMap& map, const Wall& wall,
                                                    const Point<frame::Room>& sweet_spot,
                                                    const ShowProjector& installed);

/// A camera of a known lens, wherever it stands; up to half of the pixels may be wrong.
/// Errors as fit_projector().
Result<FittedPlace<frame::Camera>> place_camera(const BrownParameters& lens, std::span<const PlacedPixel> pixels);

/// The lens of a picture that is smaller by `factor` each way, rounded down.
[[nodiscard]] BrownParameters smaller_lens(const BrownParameters& lens, int factor);

}  // namespace cyclorama
