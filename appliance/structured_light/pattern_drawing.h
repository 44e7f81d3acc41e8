// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/structured_light/pattern_set.h"
#include "common/image/image.h"

namespace cyclorama::structured_light {

/// Returns the code value, 0 to 1, that a picture of the set shows at a projector's pixel. Reentrant. Precondition: the
/// pixel is on the projector.
[[nodiscard]] double level_at(const PatternSet& set, const PatternPicture& picture, int x, int y);

/// Draws a picture in 8-bit code values; channels that PatternPicture::light excludes are dark. Reentrant.
[[nodiscard]] RgbImage drawn(const PatternSet& set, const PatternPicture& picture);

}  // namespace cyclorama::structured_light
