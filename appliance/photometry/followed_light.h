// SPDX-License-Identifier: Apache-2.0
/// Carries the brightness and colours of a calibration over to the maps of another calibration.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "appliance/calibration/colour_file.h"
#include "appliance/photometry/photometry.h"
#include "appliance/photometry/wall_light.h"
#include "appliance/solve/calibrate.h"

namespace cyclorama::photometry {

struct FollowedLight {
  std::vector<calibration::CalibratedColour> colours;
  WallLighting lighting;  ///< For light_part().
  Photometry photometry;  ///< Result of reblended().
};

/// Computes masks and colours for the maps of `after` from colours.json and light.json in `own_folder`, the folder of
/// the calibration whose maps are `before`; both have the same projectors in the same order. For `inverse_depth` see
/// move_light(); it is 1 everywhere if no wall is known. Returns nothing if the old calibration had no colours. Errors:
/// kBadData or kNotFound if the files cannot be used; kInvalidArgument if the projectors differ; otherwise those of
/// reblended(). Takes seconds.
Result<std::optional<FollowedLight>> follow_light(const std::filesystem::path& own_folder,
                                                  std::span<const calibration::CalibratedProjector> before,
                                                  std::span<const calibration::CalibratedProjector> after,
                                                  const std::function<double(const Eigen::Vector3d&)>& inverse_depth);

}  // namespace cyclorama::photometry
