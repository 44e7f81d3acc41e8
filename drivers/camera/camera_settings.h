// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/config/config.h"

namespace cyclorama::camera {

/// Returns the make_camera() line for a [camera] table: `source`, which is such a line, or one built from
/// `kind`, `port` or `device`, and the size, frame rate, exposure and memory mode; `fallback` if the table has neither.
/// Errors are recorded in the table.
[[nodiscard]] std::string camera_source(ConfigTable* camera, const std::string& fallback);

}  // namespace cyclorama::camera
