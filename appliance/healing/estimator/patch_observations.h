// SPDX-License-Identifier: Apache-2.0
/// Measurements for the solver: projector pixels that cameras saw on the wall, and points of the wall's outline, with
/// their derivatives with respect to the camera's pose.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "appliance/calibration/pose_step.h"
#include "appliance/calibration/show_calibration.h"
#include "appliance/healing/estimator/patch_alignment.h"

namespace cyclorama::healing {

using WallByCamera = Eigen::Matrix<double, 3, 6>;

/// A camera's observation of a projector's pixel on the wall.
struct PatchObservation {
  std::size_t camera = 0;
  std::size_t projector = 0;
  Eigen::Vector2d shown{0.0, 0.0};      ///< Pixel of the projector.
  Eigen::Vector2d seen{0.0, 0.0};       ///< Pixel of the camera.
  Eigen::Vector3d wall{0.0, 0.0, 0.0};  ///< Point of the wall that the camera sees at `seen`, by its believed pose.
  WallByCamera wall_by_camera = WallByCamera::Zero();
  Eigen::Matrix2d root_information = Eigen::Matrix2d::Identity();  ///< In 1 / px of the projector.
};

/// A part of the wall's outline in a camera's picture.
enum class Outline { kUpper, kLower, kSide };
struct EdgeObservation {
  std::size_t camera = 0;
  Outline part = Outline::kUpper;
  Eigen::Vector2d at{0.0, 0.0};  ///< Expected position in camera pixels.
  double off_px = 0.0;           ///< Measured distance of the edge from `at`, along the outward normal.
  double sigma_px = 1.0;
  /// Derivative of `off_px` with respect to the camera's pose.
  Eigen::Matrix<double, 1, 6> by_camera = Eigen::Matrix<double, 1, 6>::Zero();
};

/// Returns the observation of a position in a camera's picture, with `wall_by_camera`; empty if the ray misses the
/// wall. `covariance` is that of the position, in camera pixels. The observation's sigma is at least `min_sigma_px`, in
/// projector pixels.
[[nodiscard]] std::optional<PatchObservation> patch_observation(const calibration::ShowCalibration& room,
                                                                std::size_t camera, std::size_t projector,
                                                                const Eigen::Vector2d& shown,
                                                                const Eigen::Vector2d& seen,
                                                                const Eigen::Matrix2d& covariance, double min_sigma_px);

/// Returns observations of all patches that fit. `predicted` is the room of the prediction, `room` the believed room.
[[nodiscard]] std::vector<PatchObservation> patch_observations(const calibration::ShowCalibration& predicted,
                                                               const calibration::ShowCalibration& room,
                                                               std::size_t camera, int factor,
                                                               std::span<const PatchShift> patches,
                                                               double min_sigma_px);

/// Motion of a projector's pixels on the wall when the projector moves by a small step.
struct PixelMotion {
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_step;  ///< Derivatives: two rows per pixel of a grid.

  /// Returns the root mean square motion over the picture for a step.
  [[nodiscard]] double rms_px(const calibration::PoseStep& step) const;
  [[nodiscard]] double sigma_px(const calibration::PoseMatrix& covariance) const;
};
[[nodiscard]] PixelMotion pixel_motion(const calibration::ShowCalibration& room,
                                       const calibration::ShowProjector& projector);

}  // namespace cyclorama::healing
