// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/photometry/blend_weights.h"
#include "appliance/photometry/common_gamut.h"
#include "appliance/photometry/photometry.h"
#include "appliance/photometry/wall_light.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Computes masks, black lifts and matrices of all heads from the projectors' lighting. `gamut` is null if the camera
/// has no colour. Writes Photometry::heads, wall, light_kept and light_kept_flat of `result`. Errors: those of
/// DirectionField::over(). Reentrant.
Status make_heads(const PhotometryInput& input, const PhotometryOptions& options, const WallLighting& lighting,
                  const BlendWeights& weights, const CommonGamut* gamut, Photometry* result);

}  // namespace cyclorama::photometry
