// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "appliance/tracker/tag_pose.h"
#include "common/wand/wand.h"

namespace cyclorama::tracker {

/// Returns the poses that explain all corners of all tags of a wand in one picture.
///
/// Every single tag proposes its two poses (tag_pose.h); from each, the pose of the whole wand is refined on all
/// corners, each weighted by its own covariance (fit_pose()). If tags in different planes are visible, one minimum
/// remains. A single tag leaves two; then a tag that should be visible and is not found counts a little against a pose,
/// since it may be covered.
///
/// `seen` holds tags of this wand; others are ignored, and of two with one id the first counts. `corner_floor_px` is
/// added to every corner's deviation for lens, paper and folding. Reentrant. Empty if no pose is in front of the camera
/// or the corners determine none. Preconditions: corner_floor_px > 0, the lens has a focal length.
[[nodiscard]] std::optional<TagPoses> estimate_wand_poses(const Wand& wand, std::span<const tags::TagDetection> seen,
                                                          double corner_floor_px, const Pinhole& lens);

/// Returns the covariance if either of two poses may be the true one: `chosen` with `probability`, else `other`.
[[nodiscard]] Matrix6d mixed_covariance(const TagPose& chosen, const TagPose& other, double probability);

}  // namespace cyclorama::tracker
