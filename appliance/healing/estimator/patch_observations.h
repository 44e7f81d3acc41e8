// SPDX-License-Identifier: Apache-2.0
/// What was measured, as the solver wants it: projector pixels that cameras saw land somewhere, and points of the
/// wall's outline. Each carries how it would change if the camera stood elsewhere.
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

/// A camera saw a projector's pixel on the wall.
struct PatchObservation {
  std::size_t camera = 0;
  std::size_t projector = 0;
  Eigen::Vector2d shown{0.0, 0.0};      ///< The projector's pixel.
  Eigen::Vector2d seen{0.0, 0.0};       ///< The camera's.
  Eigen::Vector3d wall{0.0, 0.0, 0.0};  ///< What the camera, where it is believed to be, looks at there.
  WallByCamera wall_by_camera = WallByCamera::Zero();
  Eigen::Matrix2d root_information = Eigen::Matrix2d::Identity();  ///< 1 / projector px.
};

/// Of the wall's outline, as a camera sees it.
enum class Outline { kUpper, kLower, kSide };
struct EdgeObservation {
  std::size_t camera = 0;
  Outline part = Outline::kUpper;
  Eigen::Vector2d at{0.0, 0.0};  ///< Where it was expected, camera pixels.
  double off_px = 0.0;           ///< How far beyond that it is, along the outward normal.
  double sigma_px = 1.0;
  Eigen::Matrix<double, 1, 6> by_camera = Eigen::Matrix<double, 1, 6>::Zero();  ///< How far it would move.
};

/// The place in a camera's picture with which `wall_by_camera` comes; nothing where it misses the wall. `covariance` of
/// the place, in camera pixels. A patch_observation is never better than `min_sigma_px` of the projector.
[[nodiscard]] std::optional<PatchObservation> patch_observation(const calibration::ShowCalibration& room,
                                                                std::size_t camera, std::size_t projector,
                                                                const Eigen::Vector2d& shown,
                                                                const Eigen::Vector2d& seen,
                                                                const Eigen::Matrix2d& covariance, double min_sigma_px);

/// Of all patches that fit. `predicted` is the room that the prediction was made for, `room` what is believed now.
[[nodiscard]] std::vector<PatchObservation> patch_observations(const calibration::ShowCalibration& predicted,
                                                               const calibration::ShowCalibration& room,
                                                               std::size_t camera, int factor,
                                                               std::span<const PatchShift> patches,
                                                               double min_sigma_px);

/// How a projector's pixels move on the wall when it moves: root mean square over its picture, per step.
struct PixelMotion {
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_step;  ///< Two rows per pixel of a grid.

  [[nodiscard]] double rms_px(const calibration::PoseStep& step) const;
  [[nodiscard]] double sigma_px(const calibration::PoseMatrix& covariance) const;
};
[[nodiscard]] PixelMotion pixel_motion(const calibration::ShowCalibration& room,
                                       const calibration::ShowProjector& projector);

}  // namespace cyclorama::healing
