// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"

namespace cyclorama::structured_light {

/// One photograph as light: linear, 0 to 1, where 1 is the camera's highest code. A camera's response curve must be
/// removed first; for the signs of bits and for edges it does not matter.
using Photo = Image<float, 1>;

/// Converts 8-bit codes without linearising them.
[[nodiscard]] Photo photo_of(const GreyImage& codes);

}  // namespace cyclorama::structured_light
