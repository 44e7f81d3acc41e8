// SPDX-License-Identifier: Apache-2.0
/// Where a solver starts from, by linear algebra alone. Source: Zhang, "A Flexible New Technique for Camera
/// Calibration", PAMI 22 (11), 2000; Hartley and Zisserman, "Multiple View Geometry", 2nd edition, sections 4.1, 6.2
/// and 7.1.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace cyclorama::camera_calibration {

/// A rotation and what follows it: p_to = R p_from + t.
struct StartPose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
};

/// From a plane to pixels. Nothing when fewer than 4 points, or all on a line.
[[nodiscard]] std::optional<Eigen::Matrix3d> homography(const std::vector<Eigen::Vector2d>& from,
                                                        const std::vector<Eigen::Vector2d>& to);

/// The focal length that makes boards of these homographies rigid, the lens's centre being known; nothing when they do
/// not say (all of them face the camera).
[[nodiscard]] std::optional<double> focal_from(const std::vector<Eigen::Matrix3d>& homographies,
                                               const Eigen::Vector2d& centre_px);

/// The board before the lens.
[[nodiscard]] StartPose board_pose(const Eigen::Matrix3d& homography, double focal_px,
                                   const Eigen::Vector2d& centre_px);

/// A pinhole with any centre, and its place, from points in space that do not lie in one plane.
struct StartPinhole {
  double focal_px = 0.0;
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  StartPose pose;
};
[[nodiscard]] std::optional<StartPinhole> pinhole_from(const std::vector<Eigen::Vector3d>& points,
                                                       const std::vector<Eigen::Vector2d>& pixels);

}  // namespace cyclorama::camera_calibration
