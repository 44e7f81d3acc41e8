// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "appliance/tracker/tag_pose.h"
#include "common/wand/wand.h"

namespace cyclorama::tracker {

/// The poses that explain all corners of all tags of a wand that one picture shows.
///
/// Every tag alone proposes its two poses (tag_pose.h); from each the pose of the whole wand is refined on all corners,
/// each weighted by its own covariance (fit_pose()). Where tags in different planes are seen one minimum remains; a
/// lone tag leaves two, and then a tag that should be seen and is not speaks against a pose a little: it may be
/// covered.
///
/// `seen` holds tags of this wand; others are left out, and of two with one id the first counts. `corner_floor_px` is
/// added to every corner's deviation: what lens, paper and folding leave. Reentrant. Nothing when no pose is in front
/// of the camera or the corners determine none. Preconditions: corner_floor_px > 0, the lens has a focal length.
[[nodiscard]] std::optional<TagPoses> estimate_wand_poses(const Wand& wand, std::span<const tags::TagDetection> seen,
                                                          double corner_floor_px, const Pinhole& lens);

/// The covariance when either of two poses may be the true one: the first's with `probability`, else the other's.
[[nodiscard]] Matrix6d mixed_covariance(const TagPose& chosen, const TagPose& other, double probability);

}  // namespace cyclorama::tracker
