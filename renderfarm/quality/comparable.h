// SPDX-License-Identifier: Apache-2.0
/// What two pictures must be before an error between them means anything. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// kInvalidArgument, with both sizes, unless they are equal and not empty.
Status check_same_size(int width, int height, int reference_width, int reference_height);

/// kBadData, naming the pixel, where a value is NaN or infinite: an average that leaves it out would hide a broken
/// kernel, and one that takes it in says nothing of the other pixels.
Status check_finite(const RadianceImage& picture);

/// Both of them.
Status check_comparable(const RadianceImage& picture, const RadianceImage& reference);

}  // namespace cyclorama
