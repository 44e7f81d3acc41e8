// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "appliance/solve/calibrate.h"

namespace cyclorama::solve {

/// Registration error: the distance on the wall, in projector pixels, between two projectors' drawings of a point that
/// one camera pixel saw lit by both. It includes the noise of single correspondences.
struct MeasuredRegistration {
  double mean_px = 0.0;
  double p95_px = 0.0;
  std::size_t correspondences = 0;  ///< 0 if no two projectors were seen to overlap.
};

/// Measures the registration. The result does not depend on the camera's model, since a camera pixel sees one point of
/// the wall under any model. Reentrant.
[[nodiscard]] MeasuredRegistration measured_registration(const Measurements& measurements,
                                                         const calibration::Calibration& calibration);

}  // namespace cyclorama::solve
