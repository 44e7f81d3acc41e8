// SPDX-License-Identifier: Apache-2.0
/// Initial estimates for the solvers, by linear algebra alone. Source: Zhang, "A Flexible New Technique for Camera
/// Calibration", PAMI 22 (11), 2000; Hartley and Zisserman, "Multiple View Geometry", 2nd edition, sections 4.1, 6.2
/// and 7.1.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace cyclorama::camera_calibration {

/// Rotation followed by a translation: p_to = R p_from + t.
struct StartPose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
};

/// Returns the homography from a plane to pixels; nothing for fewer than 4 points or collinear ones.
[[nodiscard]] std::optional<Eigen::Matrix3d> homography(const std::vector<Eigen::Vector2d>& from,
                                                        const std::vector<Eigen::Vector2d>& to);

/// Returns the focal length that follows from homographies of boards, for a known principal point; nothing if it is
/// undetermined, as when all boards face the camera.
[[nodiscard]] std::optional<double> focal_from(const std::vector<Eigen::Matrix3d>& homographies,
                                               const Eigen::Vector2d& centre_px);

/// Returns the pose of a board, in front of the lens, from the board's homography.
[[nodiscard]] StartPose board_pose(const Eigen::Matrix3d& homography, double focal_px,
                                   const Eigen::Vector2d& centre_px);

/// Pinhole camera with any principal point, and its pose.
struct StartPinhole {
  double focal_px = 0.0;
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  StartPose pose;
};
[[nodiscard]] std::optional<StartPinhole> pinhole_from(const std::vector<Eigen::Vector3d>& points,
                                                       const std::vector<Eigen::Vector2d>& pixels);

}  // namespace cyclorama::camera_calibration
