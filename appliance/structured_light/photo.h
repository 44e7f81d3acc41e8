// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"

namespace cyclorama::structured_light {

/// One photograph, as light: linear, 0 to 1, where 1 is what the camera's highest code tells. Whoever has a camera with
/// a response curve takes it off first; for the signs of bits and for edges it does not matter.
using Photo = Image<float, 1>;

/// Codes of 8 bits, taken as they are.
[[nodiscard]] Photo photo_of(const GreyImage& codes);

}  // namespace cyclorama::structured_light
