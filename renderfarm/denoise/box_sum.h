// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/denoise/plane.h"

namespace cyclorama {

/// The sum over the square of 2 * radius + 1 pixels about each pixel, as much of it as lies inside. Always added in the
/// same order, so that a pixel's sum does not depend on where the plane begins. `scratch` and `ret_sum`
/// are reshaped. Reentrant.
void box_sum(const Plane& plane, int radius, Plane* scratch, Plane* ret_sum);

}  // namespace cyclorama
