// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "appliance/tags/tag_detector.h"
#include "common/room/pinhole.h"

namespace cyclorama::tags {

/// Converts tags seen through `lens` to what a lens without distortion would have seen: corners and their covariances.
/// A tag beyond the range in which the lens is invertible is left out. Reentrant.
[[nodiscard]] std::vector<TagDetection> straightened(const std::vector<TagDetection>& seen,
                                                     const calibration::BrownLens& lens, const Pinhole& straight);

}  // namespace cyclorama::tags
