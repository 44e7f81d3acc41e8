// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "appliance/display/frame.h"
#include "common/base/result.h"

namespace cyclorama::display {

/// What the wall shows before the first frame and when the farm fails, if the museum has no picture of its own: a dim
/// evening sky over a dark ground, never garbage.
[[nodiscard]] DisplayFrame attract_frame(const PictureShape& shown);

/// The museum's own picture (PNG or JPEG), stretched over the wall from edge to edge; a dome's is its largest circle.
/// Errors of read_image();
/// kInvalidArgument  a side is over 16384 pixels.
Result<DisplayFrame> attract_frame(const PictureShape& shown, const std::filesystem::path& picture);

}  // namespace cyclorama::display
