// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/config/config.h"

namespace cyclorama::camera {

/// Returns the make_camera() line for a [camera] table: either `source`, which is such a line, or `kind` with `port` or
/// `device` and the requested picture. Errors are recorded in the table.
[[nodiscard]] std::string camera_source(ConfigTable* camera, const std::string& fallback);

}  // namespace cyclorama::camera
