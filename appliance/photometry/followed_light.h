// SPDX-License-Identifier: Apache-2.0
/// Carries the brightness and colours of a calibration over to the maps of another that has none of its own.
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

/// `own_folder` holds colours.json and light.json of the calibration whose maps are `before`; `after` are the same
/// projectors in the same order. `inverse_depth` as in move_light(): 1 everywhere if no wall is known. Returns nothing
/// if that calibration had no colours.
/// Errors: kBadData or kNotFound if its files cannot be used; kInvalidArgument if the projectors differ; otherwise
/// those of reblended(). Takes seconds.
Result<std::optional<FollowedLight>> follow_light(const std::filesystem::path& own_folder,
                                                  std::span<const calibration::CalibratedProjector> before,
                                                  std::span<const calibration::CalibratedProjector> after,
                                                  const std::function<double(const Eigen::Vector3d&)>& inverse_depth);

}  // namespace cyclorama::photometry
