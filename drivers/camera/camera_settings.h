// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/config/config.h"

namespace cyclorama::camera {

/// The line for make_camera() that a [camera] table means: either `source`, which is that line, or `kind`, with `port`
/// or `device` and what pictures are wanted. What is wrong is recorded in the table.
[[nodiscard]] std::string camera_source(ConfigTable* camera, const std::string& fallback);

}  // namespace cyclorama::camera
