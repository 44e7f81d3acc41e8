// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "appliance/tracker/tag_detector.h"
#include "common/geometry/rigid_transform.h"
#include "common/room/pinhole.h"

namespace cyclorama {

using T_CameraTag = RigidTransform<frame::Camera, frame::Tag>;

/// A pose that explains four corners, and how well.
struct TagPose {
  T_CameraTag T_camera_tag;
  double reprojection_px = 0.0;  ///< Root mean square distance of the corners from where the pose puts them.
};

/// A flat tag seen from afar looks almost the same when it is tilted the other way about the line of sight: two poses
/// explain its corners. `best` has the smaller error; `other` is absent where there is only one minimum.
struct TagPoses {
  TagPose best;
  std::optional<TagPose> other;
};

/// Both minima of the reprojection error: IPPE's two closed forms (Collins and Bartoli, "Infinitesimal Plane-Based Pose
/// Estimation", IJCV 109, 2014), each refined by Levenberg and Marquardt's method. (Debian's libapriltag exports only
/// the better of its two solutions, and minimises an error in space; the tests compare the two.)
///
/// Reentrant. Nothing when the corners are degenerate (not finite, not convex, of no area) or no pose is in front of
/// the camera. Preconditions: tag_size_m > 0, the edge of the black square; the lens has a focal length.
[[nodiscard]] std::optional<TagPoses> estimate_poses(const std::array<Eigen::Vector2d, 4>& corners, double tag_size_m,
                                                     const Pinhole& lens);

/// The tag's corners in the Tag frame, in TagDetection's order.
[[nodiscard]] std::array<Eigen::Vector3d, 4> corners_of_tag(double tag_size_m);

}  // namespace cyclorama
