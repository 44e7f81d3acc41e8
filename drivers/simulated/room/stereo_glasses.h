// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "common/room/stereo.h"

namespace cyclorama::simulated {

/// Returns the part of a head's picture that the glasses pass to one eye: that eye's pixels, enlarged to the head's
/// whole field, or the whole picture if the refreshes of the eyes alternate. Reentrant. Precondition: a dimension that
/// both eyes share is even.
[[nodiscard]] RgbImage seen_through_glasses(const RgbImage& head, StereoPacking packing, Eye eye);

}  // namespace cyclorama::simulated
