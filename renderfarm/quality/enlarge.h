// SPDX-License-Identifier: Apache-2.0
/// Enlarges pictures that were rendered at a reduced size to the size in which they are displayed. Reentrant.
#pragma once

#include "common/image/image.h"

namespace cyclorama::quality {

/// Interpolates bilinearly between pixel centres, in linear light like the display; beyond the outermost centres, the
/// outermost pixels are repeated. Precondition: the picture is not empty; `width` and `height` are above 0.
[[nodiscard]] RadianceImage enlarged(const RadianceImage& picture, int width, int height);
/// Converts code values to linear light and back.
[[nodiscard]] RgbImage enlarged(const RgbImage& picture, int width, int height);

}  // namespace cyclorama::quality
