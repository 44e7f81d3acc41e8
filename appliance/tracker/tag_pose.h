// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "appliance/tags/tag_detector.h"
#include "appliance/tracker/pose_fit.h"

namespace cyclorama::tracker {

/// The poses that explain a flat tag's corners. From afar, a tag looks almost the same when it is tilted in the
/// opposite direction about the line of sight. `best` has the smaller error; `other` is absent if there is only one
/// minimum.
struct TagPoses {
  TagPose best;
  std::optional<TagPose> other;
};

/// Returns both minima of the reprojection error, with equal weight for every corner: IPPE's two closed forms (Collins
/// and Bartoli, "Infinitesimal Plane-Based Pose Estimation", IJCV 109, 2014), each refined by fit_pose(), which assumes
/// that corners are known to 1 px. (Debian's libapriltag exports only the better of its two solutions, and minimises an
/// error in space; the tests compare both methods.)
///
/// Reentrant. Empty if the corners are degenerate (not finite, not convex, without area) or no pose is in front of the
/// camera. Preconditions: tag_size_m > 0, the edge of the black square; the lens has a focal length.
[[nodiscard]] std::optional<TagPoses> estimate_poses(const std::array<Eigen::Vector2d, 4>& corners, double tag_size_m,
                                                     const Pinhole& lens);

/// Returns the tag's corners in the Tag frame, in the order of TagDetection::corners.
[[nodiscard]] std::array<Eigen::Vector3d, 4> corners_of_tag(double tag_size_m);

}  // namespace cyclorama::tracker
