// SPDX-License-Identifier: Apache-2.0
/// Masks and colours for maps that changed, by the light that was measured before: nothing is photographed.
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

/// A projector's light falls on more of the wall, or on less, where its map is another one. `inverse_depth` is the wall's,
/// in 1/m by direction; where it or a map says nothing the light stays as it was.
void move_light(const calibration::MeasuredMap& before, const calibration::MeasuredMap& after,
                const std::function<double(const Eigen::Vector3d&)>& inverse_depth, ProjectorLighting* light);

/// What photometry() would make of the same light with these maps: responses stay, masks, matrices and lifts follow.
/// `before` says which colours there are. Of the answer, heads (without what was measured of their responses), wall and
/// light kept are told. kInvalidArgument  counts or names that do not go together. Others as
/// make_heads() and common_gamut(). Reentrant.
Result<Photometry> reblended(const std::vector<PhotometricProjector>& projectors, const WallLighting& light,
                             std::span<const calibration::CalibratedColour> before,
                             const PhotometryOptions& options = {});

}  // namespace cyclorama::photometry
