// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/photometry/blend_weights.h"
#include "appliance/photometry/common_gamut.h"
#include "appliance/photometry/photometry.h"
#include "appliance/photometry/wall_light.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

/// Masks, lifts and matrices of all heads from what the projectors light. `gamut` is null where the camera sees no
/// colours. Writes heads, wall and light kept. Errors of DirectionField::over(). Reentrant.
Status make_heads(const PhotometryInput& input, const PhotometryOptions& options, const WallLighting& lighting,
                  const BlendWeights& weights, const CommonGamut* gamut, Photometry* result);

}  // namespace cyclorama::photometry
