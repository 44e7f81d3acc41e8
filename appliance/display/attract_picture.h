// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "appliance/display/frame.h"
#include "common/base/result.h"

namespace cyclorama::display {

/// Returns the picture that the wall shows before the first frame and when the farm fails, if the museum has none of
/// its own: a dim evening sky over a dark ground.
[[nodiscard]] DisplayFrame attract_frame(const PictureShape& shown);

/// Reads the museum's own picture (PNG or JPEG) and stretches it over the wall from edge to edge; on a dome, only the
/// largest circle in the picture is visible. Errors: those of read_image(); kInvalidArgument if a side exceeds 16384
/// pixels.
Result<DisplayFrame> attract_frame(const PictureShape& shown, const std::filesystem::path& picture);

}  // namespace cyclorama::display
