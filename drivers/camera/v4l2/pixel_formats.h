// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/camera/raw_picture.h"

namespace cyclorama::camera {

/// How V4L2's pixels of this name hold brightness; nothing for those that we do not read: colour filter mosaics, RGB,
/// and video streams whose pictures need each other.
[[nodiscard]] std::optional<PixelLayout> layout_of_v4l2(std::uint32_t fourcc);

/// Where its colours are, in which order; of the range it says nothing.
[[nodiscard]] ColourCode colour_of_v4l2(std::uint32_t fourcc);

}  // namespace cyclorama::camera
