// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "renderfarm/denoise/plane.h"

namespace cyclorama::denoise {

/// Computes, for each pixel, the sum over the square of 2 * radius + 1 pixels around it, clipped to the plane. The
/// order of addition is fixed, so a pixel's sum does not depend on where the plane begins. `scratch` and `ret_sum` are
/// reshaped. Reentrant.
void box_sum(const Plane& plane, int radius, Plane* scratch, Plane* ret_sum);

}  // namespace cyclorama::denoise
