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

/// Orthogonal iteration (Lu, Hager and Mjolsness 2000) for both minima (Schweighofer and Pinz 2006), by libapriltag.
/// Reentrant. Nothing when the corners are degenerate (not finite, not convex, of no area) or no pose is in front of the
/// camera. Precondition: tag_size_m > 0, the edge of the black square.
[[nodiscard]] std::optional<TagPoses> estimate_poses(const std::array<Eigen::Vector2d, 4>& corners, double tag_size_m,
                                                     const Pinhole& lens);

/// The tag's corners in the Tag frame, in TagDetection's order.
[[nodiscard]] std::array<Eigen::Vector3d, 4> corners_of_tag(double tag_size_m);

}  // namespace cyclorama
