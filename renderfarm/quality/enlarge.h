// SPDX-License-Identifier: Apache-2.0
/// Enlarges pictures that were rendered at reduced size to the size at which they are displayed. Reentrant.
#pragma once

#include "common/image/image.h"

namespace cyclorama::quality {

/// Interpolates bilinearly between pixel centres, in linear light, as the display does. Beyond the outermost centres,
/// the outermost pixels are repeated. Precondition: the picture is not empty; `width` and `height` are above 0.
[[nodiscard]] RadianceImage enlarged(const RadianceImage& picture, int width, int height);
/// Enlarges code values by conversion to linear light and back.
[[nodiscard]] RgbImage enlarged(const RgbImage& picture, int width, int height);

}  // namespace cyclorama::quality
