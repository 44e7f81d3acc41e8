// SPDX-License-Identifier: Apache-2.0
/// Recomputes masks and colours for changed maps from the light that was measured before, without photographs.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "appliance/calibration/colour_file.h"
#include "appliance/photometry/photometry.h"
#include "appliance/photometry/photometry_input.h"
#include "appliance/photometry/wall_light.h"

namespace cyclorama::photometry {

/// Adapts a projector's light to another map, with which the light falls on a larger or smaller area of the wall.
/// `inverse_depth` returns the wall's inverse distance in a direction, in 1/m. The light is unchanged where the wall or
/// a map has no value.
void move_light(const calibration::MeasuredMap& before, const calibration::MeasuredMap& after,
                const std::function<double(const Eigen::Vector3d&)>& inverse_depth, ProjectorLighting* light);

/// Returns the result of photometry() for the same light with other maps: responses are kept; masks, matrices and black
/// lifts are computed anew. `before` holds the previous colours. Of the result, only the heads (without the
/// measurements of their responses), the wall and the light kept are set. Errors: kInvalidArgument if counts or names
/// are inconsistent; otherwise those of make_heads() and common_gamut(). Reentrant.
Result<Photometry> reblended(const std::vector<PhotometricProjector>& projectors, const WallLighting& light,
                             std::span<const calibration::CalibratedColour> before,
                             const PhotometryOptions& options = {});

}  // namespace cyclorama::photometry
