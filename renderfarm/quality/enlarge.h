// SPDX-License-Identifier: Apache-2.0
/// Pictures that were rendered small, in the size in which they are shown. Reentrant.
#pragma once

#include "common/image/image.h"

namespace cyclorama {

/// Bilinear between the centres of pixels, in linear light, as the display does it; beyond the outermost centres the
/// outermost pixels go on. Precondition: the picture is not empty, `width` and `height` are above 0.
[[nodiscard]] RadianceImage enlarged(const RadianceImage& picture, int width, int height);
/// Code values are turned to light and back.
[[nodiscard]] RgbImage enlarged(const RgbImage& picture, int width, int height);

}  // namespace cyclorama
