// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/geometry/rigid_transform.h"
#include "common/room/pinhole.h"

namespace cyclorama::tracker {

using T_CameraTag = RigidTransform<frame::Camera, frame::Tag>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A point of the pattern, where a picture shows it, and how surely.
struct SeenPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< In the Tag frame.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();  ///< Inverse covariance, 1 / px².
};

/// A pose that explains what was seen, and how well.
struct TagPose {
  T_CameraTag T_camera_tag;
  double reprojection_px = 0.0;  ///< Root mean square distance of the points from where the pose puts them.
  /// Sum of the squared errors in units of their deviations, outliers counted less: about 2 per point when the noise is
  /// as believed. Half of a difference of two misfits is a logarithm of odds.
  double misfit = 0.0;
  /// Of a small turn about the camera's axes (radians) at the tag's origin, then a shift (metres).
  Matrix6d covariance = Matrix6d::Zero();
};

/// The minimum of the misfit near `start`, by Levenberg and Marquardt's method with Cauchy's loss on each point, scale
/// 3 deviations (Triggs et al., "Bundle Adjustment - A Modern Synthesis", 1999, sections 3.3 and 6): a corner under a
/// finger pulls no more than one at 3 deviations. The covariance is the inverse of the normal matrix, times misfit per
/// degree of freedom where that is more than 1.
///
/// Reentrant. Nothing when a point is behind the lens, a number is not finite, or the points do not determine the pose
/// (fewer than 3, or on a line).
[[nodiscard]] std::optional<TagPose> fit_pose(std::span<const SeenPoint> points, const T_CameraTag& start,
                                              const Pinhole& lens);

}  // namespace cyclorama::tracker
