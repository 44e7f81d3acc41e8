// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "appliance/calibration/brown_lens.h"
#include "appliance/tags/tag_detector.h"
#include "common/room/pinhole.h"

namespace cyclorama::tags {

/// Converts tags seen through `lens`, with their corners and covariances, to what the undistorted lens `straight` would
/// have seen. A tag beyond the range in which the lens is invertible is omitted. Reentrant.
[[nodiscard]] std::vector<TagDetection> straightened(const std::vector<TagDetection>& seen,
                                                     const calibration::BrownLens& lens, const Pinhole& straight);

}  // namespace cyclorama::tags
