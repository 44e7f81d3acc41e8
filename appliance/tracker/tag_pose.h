// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "appliance/tags/tag_detector.h"
#include "appliance/tracker/pose_fit.h"

namespace cyclorama::tracker {

/// A flat tag seen from afar looks almost the same when it is tilted the other way about the line of sight: two poses
/// explain its corners. `best` has the smaller error; `other` is absent where there is only one minimum.
struct TagPoses {
  TagPose best;
  std::optional<TagPose> other;
};

/// Both minima of the reprojection error, every corner alike: IPPE's two closed forms (Collins and Bartoli,
/// "Infinitesimal Plane-Based Pose Estimation", IJCV 109, 2014), each refined by fit_pose() for corners known to 1 px.
/// (Debian's libapriltag exports only the better of its two solutions, and minimises an error in space; the
/// tests compare the two.)
///
/// Reentrant. Nothing when the corners are degenerate (not finite, not convex, of no area) or no pose is in front of
/// the camera. Preconditions: tag_size_m > 0, the edge of the black square; the lens has a focal length.
[[nodiscard]] std::optional<TagPoses> estimate_poses(const std::array<Eigen::Vector2d, 4>& corners, double tag_size_m,
                                                     const Pinhole& lens);

/// The tag's corners in the Tag frame, in TagDetection's order.
[[nodiscard]] std::array<Eigen::Vector3d, 4> corners_of_tag(double tag_size_m);

}  // namespace cyclorama::tracker
