// SPDX-License-Identifier: Apache-2.0
/// Conditions under which an error between two pictures is meaningful. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

/// Errors: kInvalidArgument, with both sizes, unless they are equal and not empty.
Status check_same_size(int width, int height, int reference_width, int reference_height);

/// Errors: kBadData, naming the pixel, if a value is NaN or infinite. An average that omits it would hide a broken
/// kernel, and one that includes it would be meaningless for the other pixels.
Status check_finite(const RadianceImage& picture);

/// Checks the sizes, then both pictures.
Status check_comparable(const RadianceImage& picture, const RadianceImage& reference);

}  // namespace cyclorama::quality
