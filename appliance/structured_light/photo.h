// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"

namespace cyclorama::structured_light {

/// One photograph in linear light, 0 to 1, where 1 is the light of the camera's highest code. The camera's response
/// curve should be removed before, but it affects neither the signs of bits nor edges.
using Photo = Image<float, 1>;

/// Converts 8-bit codes without linearising them.
[[nodiscard]] Photo photo_of(const GreyImage& codes);

}  // namespace cyclorama::structured_light
