// SPDX-License-Identifier: Apache-2.0
/// Conditions under which an error between two pictures is meaningful. Reentrant.
#pragma once

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama::quality {

/// Checks that both sizes are equal and not empty. Errors: kInvalidArgument, with both sizes.
Status check_same_size(int width, int height, int reference_width, int reference_height);

/// Checks that no value is NaN or infinite. An average that omits such a value would hide a broken kernel, and one that
/// includes it would be meaningless. Errors: kBadData, naming the pixel.
Status check_finite(const RadianceImage& picture);

/// Checks that both pictures have the same size and finite values.
Status check_comparable(const RadianceImage& picture, const RadianceImage& reference);

}  // namespace cyclorama::quality
