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

/// A point of the pattern, its position in a picture, and the certainty of that position.
struct SeenPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< In the Tag frame.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();  ///< Inverse covariance, 1 / px².
};

/// A pose that explains the observed points, and the quality of the fit.
struct TagPose {
  T_CameraTag T_camera_tag;
  double reprojection_px = 0.0;  ///< Root mean square distance of the points from their projections.
  /// Sum of the squared errors in units of their deviations, with less weight for outliers: about 2 per point if the
  /// noise is as assumed. Half of the difference between two misfits is a log-odds.
  double misfit = 0.0;
  /// Covariance of a small turn about the camera's axes (radians) at the tag's origin, followed by a shift (metres).
  Matrix6d covariance = Matrix6d::Zero();
};

/// Returns the minimum of the misfit near `start`, by the method of Levenberg and Marquardt, with Cauchy's loss on each
/// point at a scale of 3 deviations (Triggs et al., "Bundle Adjustment - A Modern Synthesis", 1999, sections 3.3 and
/// 6): a corner covered by a finger has no more influence than one at 3 deviations. The covariance is the inverse of
/// the normal matrix, multiplied by the misfit per degree of freedom if that ratio exceeds 1.
///
/// Reentrant. Empty if a point is behind the lens, a number is not finite, or the points do not determine the pose
/// (fewer than 3, or collinear).
[[nodiscard]] std::optional<TagPose> fit_pose(std::span<const SeenPoint> points, const T_CameraTag& start,
                                              const Pinhole& lens);

}  // namespace cyclorama::tracker
