// SPDX-License-Identifier: Apache-2.0
/// Solves for the responses of the camera and of all channels by one least-squares problem over all ramps. For a cell
/// of a projector's picture, seen by a channel of the camera at a stop,
///
///     light_of(code) = exposure * (rest + share_l * response_l(level))          l: red, green, blue, white
///
/// `rest` is the light at black: ambient light and black level. `rest` and `share` are separate for each cell, so
/// vignetting, the wall's paint and incidence cancel. Exposures are known exactly; this determines the camera's light
/// up to its unit, and the dark code, which does not grow with the exposure.
///   Source: Debevec and Malik, "Recovering High Dynamic Range Radiance Maps from Photographs", SIGGRAPH 1997, for the
///   idea; here with unknown curves on both sides, after Golub and Pereyra (variable projection), SIAM J. Numer. Anal.
///   10 (2), 1973.
#pragma once

#include <array>
#include <vector>

#include "appliance/photometry/camera_response.h"
#include "appliance/photometry/channel_response.h"
#include "appliance/photometry/photometry_input.h"
#include "common/base/result.h"

namespace cyclorama::photometry {

struct SolvedResponses {
  CameraResponse camera;
  std::vector<std::array<std::vector<ResponsePoint>, 3>> channels;  ///< Per projector: red, green, blue.
  double residual = 0.0;  ///< RMS over the readings, as a fraction of the camera's full scale.
};

/// Solves for all responses. Errors: kInvalidArgument if a projector lacks ramps of red, green and blue, or all
/// exposures are the same; kBadData if a projector or one of its channels has no light, or all readings are clipped or
/// dark. Reentrant.
Result<SolvedResponses> solve_responses(const PhotometryInput& input);

}  // namespace cyclorama::photometry
