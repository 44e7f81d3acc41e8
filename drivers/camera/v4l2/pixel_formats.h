// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/camera/raw_picture.h"

namespace cyclorama::camera {

/// Returns the brightness layout of a V4L2 pixel format; nothing for formats that are not supported: colour filter
/// mosaics, RGB, and inter-coded video streams.
[[nodiscard]] std::optional<PixelLayout> layout_of_v4l2(std::uint32_t fourcc);

/// Returns the position and order of a V4L2 pixel format's colours; `is_full_range` keeps its default.
[[nodiscard]] ColourCode colour_of_v4l2(std::uint32_t fourcc);

}  // namespace cyclorama::camera
