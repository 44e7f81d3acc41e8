// SPDX-License-Identifier: Apache-2.0
/// The camera's response and every channel's, from one least-squares problem over all ramps. For a cell of a
/// projector's picture, seen by a channel of the camera at a stop,
///
///     light_of(code) = exposure * (rest + share_l * response_l(level))          l: red, green, blue, white
///
/// `rest` is what shines at black: ambient light, leaks. `rest` and `share` are each cell's own, so vignetting, the
/// wall's paint and incidence cancel; exposures are known exactly, so the camera's light is known up to its unit, and
/// its code of darkness too, since that does not grow with the exposure.
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
  double residual = 0.0;  ///< Of the readings, root mean square, in parts of the camera's full scale.
};

/// kInvalidArgument  a projector without ramps of red, green and blue, or exposures that are all alike.
/// kBadData  a projector or one of its channels that does not shine, or readings all clipped or all dark.
/// Reentrant.
Result<SolvedResponses> solve_responses(const PhotometryInput& input);

}  // namespace cyclorama::photometry
