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

/// Adapts a projector's light to another map, with which it falls on a larger or smaller part of the wall.
/// `inverse_depth` is that of the wall, in 1/m by direction; where it or a map has no value the light is unchanged.
void move_light(const calibration::MeasuredMap& before, const calibration::MeasuredMap& after,
                const std::function<double(const Eigen::Vector3d&)>& inverse_depth, ProjectorLighting* light);

/// Returns what photometry() would compute from the same light with these maps: responses are kept; masks, matrices and
/// black lifts follow. `before` holds the previous colours. The result has only heads (without the measurements of
/// their responses), wall and light kept. Errors: kInvalidArgument if counts or names are inconsistent; otherwise those
/// of make_heads() and common_gamut(). Reentrant.
Result<Photometry> reblended(const std::vector<PhotometricProjector>& projectors, const WallLighting& light,
                             std::span<const calibration::CalibratedColour> before,
                             const PhotometryOptions& options = {});

}  // namespace cyclorama::photometry
