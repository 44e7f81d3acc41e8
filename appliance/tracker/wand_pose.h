// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "appliance/tracker/tag_pose.h"
#include "common/wand/wand.h"

namespace cyclorama::tracker {

/// Returns the poses that explain all corners of all tags of a wand in one picture.
///
/// Every tag proposes its two poses (tag_pose.h); from each of them, the pose of the whole wand is refined on all
/// corners, each weighted by its own covariance (fit_pose()). If tags in different planes are visible, one minimum
/// remains. If only one tag is visible, two remain; then each tag that a pose makes visible but that was not found
/// counts a little against that pose, since the tag may also be covered.
///
/// `seen` may contain tags of other wands, which are ignored; of two tags with the same id the first counts.
/// `corner_floor_px` is added to every corner's deviation for lens, paper and folding. Reentrant. Empty if no pose is
/// in front of the camera, or if the corners do not determine one. Preconditions: corner_floor_px > 0, the lens has a
/// focal length.
[[nodiscard]] std::optional<TagPoses> estimate_wand_poses(const Wand& wand, std::span<const tags::TagDetection> seen,
                                                          double corner_floor_px, const Pinhole& lens);

/// Returns the covariance of a pose that is `chosen` with `probability`, else `other`.
[[nodiscard]] Matrix6d mixed_covariance(const TagPose& chosen, const TagPose& other, double probability);

}  // namespace cyclorama::tracker
