// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "appliance/tags/tag_detector.h"
#include "common/room/pinhole.h"

namespace cyclorama::tags {

/// What was seen through `lens`, as a lens without distortion would have seen it: corners and their covariances. A tag
/// that reaches beyond what the lens can tell is left out. Reentrant.
[[nodiscard]] std::vector<TagDetection> straightened(const std::vector<TagDetection>& seen,
                                                     const calibration::BrownLens& lens, const Pinhole& straight);

}  // namespace cyclorama::tags
