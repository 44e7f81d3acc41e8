// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "appliance/calibration/measured_lens.h"
#include "common/base/result.h"

namespace cyclorama::scan {

/// Of the scan's camera, what `cyclorama calibrate-camera` found, with its covariance: a prior for the solver.
///
///     `file`                  where one is named: it is this camera's, whatever id stands in it
///     FOLDER/camera.json      else, where there is one and its id is the camera's
///
/// Nothing where neither is there: the field of view serves then. kInvalidArgument  it is of pictures of another shape.
/// Others as read_camera(), with what to do.
Result<std::optional<calibration::MeasuredLens>> known_lens(const std::filesystem::path& file,
                                                            const std::filesystem::path& folder,
                                                            const std::string& camera_id, int width_px, int height_px);

}  // namespace cyclorama::scan
