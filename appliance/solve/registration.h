// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "appliance/solve/calibrate.h"

namespace cyclorama::solve {

/// How far apart two projectors draw what one pixel of the camera saw both of: in projector pixels, on the wall, with
/// the noise of those single places in it.
struct MeasuredRegistration {
  double mean_px = 0.0;
  double p95_px = 0.0;
  std::size_t correspondences = 0;  ///< 0: no two projectors were seen to overlap.
};

/// A pixel of the camera belongs to one place of the wall, whatever is known of the camera: what is told here needs no
/// model of it. Reentrant.
[[nodiscard]] MeasuredRegistration measured_registration(const Measurements& measurements,
                                                         const calibration::Calibration& calibration);

}  // namespace cyclorama::solve
