// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "appliance/calibration/measured_lens.h"
#include "common/base/result.h"

namespace cyclorama::scan {

/// Returns the lens of the scan's camera, with its covariance, as `cyclorama calibrate-camera` measured it. It serves
/// as a prior for the solver.
///
///     `file`                  if it is not empty: used whatever camera id it contains
///     FOLDER/camera.json      otherwise, if it exists and its id is `camera_id`
///
/// Returns nothing if there is no lens; callers use the field of view instead. Errors: kInvalidArgument if the lens
/// belongs to pictures of another aspect ratio; otherwise those of read_camera(), with the remedy.
Result<std::optional<calibration::MeasuredLens>> known_lens(const std::filesystem::path& file,
                                                            const std::filesystem::path& folder,
                                                            const std::string& camera_id, int width_px, int height_px);

}  // namespace cyclorama::scan
