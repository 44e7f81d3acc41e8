// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "appliance/display/frame.h"

namespace cyclorama {

/// What the wall shows before the first frame: a dim evening sky over a dark ground, never garbage.
[[nodiscard]] Frame attract_frame(const Panorama& shown);

}  // namespace cyclorama
