// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/image/image.h"
#include "common/room/stereo.h"

namespace cyclorama::simulated {

/// What glasses let through to one eye of what a head shows: the pixels that are the eye's, over the head's whole
/// field. Where eyes take turns, the whole picture. Reentrant. Precondition: a side that both eyes share is even.
[[nodiscard]] RgbImage seen_through_glasses(const RgbImage& head, StereoPacking packing, Eye eye);

}  // namespace cyclorama::simulated
